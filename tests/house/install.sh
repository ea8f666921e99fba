#!/usr/bin/env bash
# Installs a build, moves it elsewhere and uses it from outside: C and C++, CMake and pkg-config, core and scene.
# Without PELLICLE_ALL in the environment (.ci/run and make nightly set it) only one program of each kind is built.
# usage: install.sh SOURCE BUILD C_COMPILER C++_COMPILER
set -euo pipefail
source=$1 build=$2
export CC=$3 CXX=$4
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "error: $*" >&2; exit 1; }
quietly() { "$@" >"$place/log" 2>&1 || { cat "$place/log"; fail "failed: $*"; }; }

# `make install` builds the target `installed`: it makes each library and program that is copied
ninja -C "$build" -t query installed | sed 's/^ *//' >"$place/made"
grep -oE '"'"$build"'/(lib[^/"]*\.(a|so)|pellicle)"' "$build/cmake_install.cmake" | sed 's|.*/||; s|"||' | sort -u >"$place/copied"
grep -qx pellicle "$place/copied" || [ ! -x "$build/pellicle" ] || fail "cmake_install.cmake was not understood"
while read -r file; do
    grep -qx "$file" "$place/made" || fail "the target installed does not make $file"
done <"$place/copied"

quietly cmake --install "$build" --prefix "$place/first"
mv "$place/first" "$place/prefix"
! grep -rlF -e "$source" -e "$place/first" "$place/prefix/lib" "$place/prefix/share" --include='*.cmake' --include='*.pc' ||
    fail "installed files name folders of this machine"
[ -f "$place/prefix/include/pellicle/pellicle.h" ] || fail "no headers"

# what the installed README links to is installed
doc=$(dirname "$(find "$place/prefix/share/doc" -name README.md -not -path '*/examples/*')")
grep -oE '\]\([^)#:]+' "$doc/README.md" | sed 's/^](//' | sort -u >"$place/links"
[ "$(wc -l <"$place/links")" -gt 20 ] || fail "the links of README.md were not understood"
while read -r link; do
    [ -e "$doc/$link" ] || fail "the installed README.md links to $link, which is not installed"
done <"$place/links"

# name, source folder, options
outside() {
    quietly cmake -G Ninja -S "$2" -B "$place/$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$place/prefix" "${@:3}"
    quietly cmake --build "$place/$1"
}
outside core "$source/tests/house/outside"
"$place/core/outside"

export PKG_CONFIG_PATH="$place/prefix/lib/pkgconfig"
[ -f "$PKG_CONFIG_PATH/pellicle.pc" ] || fail "no pellicle.pc in lib/pkgconfig"
[ "$(pkg-config --modversion pellicle)" = "$(sed -n 's/.*PEL_VERSION "\(.*\)"/\1/p' "$source/include/pellicle/base.h")" ] ||
    fail "pellicle.pc and base.h have different versions"
# the shared library, and the archive without it
export LD_LIBRARY_PATH="$place/prefix/lib"
for package in pellicle pellicle-static; do
    # shellcheck disable=SC2046
    "$CC" "$source/examples/press/main.c" $(pkg-config --cflags --libs $package) -o "$place/press-$package"
    # shellcheck disable=SC2046
    "$CXX" "$source/tests/house/outside/core.cpp" $(pkg-config --cflags --libs $package) -o "$place/core-$package"
    "$place/core-$package"
done
soname=$(sed -n 's/.*PEL_VERSION "\([0-9]*\.[0-9]*\)\..*"/libpellicle.so.\1/p' "$source/include/pellicle/base.h")
# output kept: grep -q would end the pipe early
readelf -d "$place/press-pellicle" >"$place/needed"
grep -qF "[$soname]" "$place/needed" || fail "the program of pkg-config pellicle does not need $soname"
readelf -d "$place/press-pellicle-static" >"$place/needed"
! grep -qF libpellicle "$place/needed" || fail "the program of pkg-config pellicle-static needs libpellicle.so"
if [ -x "$place/prefix/bin/pellicle" ]; then
    "$place/prefix/bin/pellicle" --version
    for scene in "$place"/prefix/share/pellicle/scenes/*.yaml; do
        quietly "$place/prefix/bin/pellicle" check "$scene"
    done
    bash -n "$place/prefix/share/bash-completion/completions/pellicle"
fi

if [ -z "${PELLICLE_ALL:-}" ]; then
    echo "long: the examples, the shared library and the scene library from outside"
    exit 0
fi
outside press "$source/examples/press"
outside drag "$source/examples/drag"
outside haptic "$source/examples/haptic"
outside core-shared "$source/tests/house/outside" -DSHARED=ON
"$place/core-shared/outside"
readelf -d "$place/core-shared/outside" >"$place/needed"
grep -qF "[$soname]" "$place/needed" || fail "the program of pellicle::shared does not need $soname"

# all builds of the example print the same: a force at the deepest point (line 4), none at the end (line 12)
"$place/press/press" | tee "$place/press.txt"
for package in pellicle pellicle-static; do
    "$place/press-$package" | cmp - "$place/press.txt"
done
awk '/force/ { force[NR] = $7 } END { exit !(NR == 12 && force[4] > 0 && force[12] == 0) }' "$place/press.txt" ||
    fail "the force on the ball does not rise and fall"

"$place/drag/drag" | tee "$place/drag.txt"
grep -q "the same bits as at the start" "$place/drag.txt" || fail "the example does not take its changes back"

"$place/haptic/haptic" recorded | tee "$place/haptic.txt"
awk '/^largest force/ { error = $NF == "%" ? $(NF - 1) : 100 } END { exit !(error > 0 && error < 3) }' "$place/haptic.txt" ||
    fail "the force of the haptic loop is off by 3 % or more"

if [ -f "$PKG_CONFIG_PATH/pellicle-scene.pc" ]; then
    outside scene "$source/tests/house/outside" -DSCENE=ON
    "$place/scene/outside"
    # shellcheck disable=SC2046
    "$CXX" "$source/tests/house/outside/scene.cpp" $(pkg-config --cflags --libs pellicle-scene) -o "$place/scene-cxx"
    "$place/scene-cxx"
fi
