#!/usr/bin/env bash
# Installs the Debian packages that a task needs, only those that are missing.
#   bash scenes/install_packages.sh build|test
# build: what the demo needs to compile and run; test: that and what the tests need.
set -euo pipefail

build=(ca-certificates cmake g++ ninja-build libeigen3-dev nlohmann-json3-dev libvalijson-dev libtinygltf-dev libcli11-dev
    libvulkan1 libvulkan-dev glslang-tools mesa-vulkan-drivers)
test=(libgtest-dev libcgal-dev libsuitesparse-dev libopenblas-pthread-dev vulkan-validationlayers gnuplot-nox)

case "${1:-}" in
    build) packages=("${build[@]}") ;;
    test) packages=("${build[@]}" "${test[@]}") ;;
    *)
        echo "usage: install_packages.sh build|test" >&2
        exit 2
        ;;
esac
# Any node will do; Debian's only where there is none.
if ! command -v node >/dev/null; then packages+=(nodejs); fi
if ! command -v npm >/dev/null; then packages+=(npm); fi

missing=()
for package in "${packages[@]}"; do
    state=$(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
    if [[ $state != ii* ]]; then missing+=("$package"); fi
done
if [ ${#missing[@]} -eq 0 ]; then
    echo "== Debian packages: all ${#packages[@]} are there"
    exit 0
fi

echo "== Debian packages: installing ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "install_packages.sh: not root and no sudo; as root run: apt-get install -y --no-install-recommends ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null
