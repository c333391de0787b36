#!/usr/bin/env bash
# From a bare Debian 12 to decorated models: installs what is missing, builds, makes the meshes and decorates the demo scenes.
#   bash scenes/demo.sh
# Runs from any folder, as root or with sudo, and again at any time.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

bash scenes/install_packages.sh build

echo "== build (build/release)"
# A build folder that the tests configured stays as they left it.
tests=()
if [ ! -f build/release/CMakeCache.txt ]; then tests=(-DPVG_BUILD_TESTS=OFF); fi
cmake --preset release "${tests[@]}" --log-level=WARNING
cmake --build --preset release --target pvg -j "$(nproc)"
pvg=$(find build/release -type f -name pvg -perm -u+x -print -quit)

echo "== meshes (build/demo)"
mkdir -p build/demo
if [ ! -d build/node/node_modules/bunny ]; then
    npm install --prefix build/node --no-fund --no-audit --loglevel=error bunny@1.0.1
fi
"$pvg" make cuboid --vertices 40000 -o build/demo/box.glb
"$pvg" make cuboid --vertices 40000 -o build/demo/flag.glb
"$pvg" make plane --vertices 40000 -o build/demo/two_regions.glb
node scenes/bunny_glb.mjs build/node/node_modules build/demo/bunny.glb

echo "== decorate"
for scene in box flag two_regions bunny; do
    # A scene names its mesh relative to itself.
    cp "scenes/$scene.pvg.json" "build/demo/$scene.pvg.json"
    "$pvg" decorate "build/demo/$scene.pvg.json" -o "build/demo/${scene}_decorated.glb" --report "build/demo/$scene.report.json"
    node -e '
        const report = JSON.parse(require("fs").readFileSync(process.argv[1], "utf8"));
        const size = (n) => n.toLocaleString("en-US");
        console.log(`   ${process.argv[2]}: ${report.primitives} primitives, ${size(report.vertices.in)} -> ${size(report.vertices.out)} vertices, ` +
            `${size(report.knots)} knots, ${report.total.toFixed(2)} s on ${report.device.name}`);
        for (const warning of report.warnings) console.log(`   warning: ${warning}`);
    ' "build/demo/$scene.report.json" "build/demo/${scene}_decorated.glb"
done

echo "== done: open these in any glTF viewer"
for scene in box flag two_regions bunny; do echo "$root/build/demo/${scene}_decorated.glb"; done
