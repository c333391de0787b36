#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test.
#   bash tests/run.sh [arguments for ctest]
# PVG_TEST_DATA names a folder with further real files; the tests that need it are skipped where it is not set.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

bash scenes/install_packages.sh test
echo "== configure and build (build/release)"
cmake --preset release -DPVG_BUILD_TESTS=ON
cmake --build --preset release -j "$(nproc)"

echo "== node modules for the tests (build/node)"
if [ ! -d build/node/node_modules/gltf-validator ] || [ ! -d build/node/node_modules/bunny ]; then
    npm install --prefix build/node --no-fund --no-audit --loglevel=error gltf-validator@2.0.0-dev.3.10 bunny@1.0.1
fi
export PVG_NODE_MODULES="$root/build/node/node_modules"
# The convergence study leaves its table and its plot here.
export PVG_CONVERGENCE="$root/build/convergence"

echo "== tests"
started=$SECONDS
ctest --preset release -j "$(nproc)" "$@"
echo "tests took $((SECONDS - started)) s; build/release/Testing holds their log"
