#!/usr/bin/env bash
# Installs a build, moves it elsewhere and uses it from outside: C and C++, CMake and pkg-config, core and scene.
# usage: install.sh SOURCE BUILD C_COMPILER C++_COMPILER
set -euo pipefail
source=$1 build=$2
export CC=$3 CXX=$4
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "error: $*" >&2; exit 1; }
quietly() { "$@" >"$place/log" 2>&1 || { cat "$place/log"; fail "failed: $*"; }; }

quietly cmake --install "$build" --prefix "$place/first"
mv "$place/first" "$place/prefix"
! grep -rlF -e "$source" -e "$place/first" "$place/prefix/lib" "$place/prefix/share" --include='*.cmake' --include='*.pc' ||
    fail "installed files name folders of this machine"
[ -f "$place/prefix/include/pellicle/pellicle.h" ] || fail "no headers"

# name, source folder, options
outside() {
    quietly cmake -G Ninja -S "$2" -B "$place/$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$place/prefix" "${@:3}"
    quietly cmake --build "$place/$1"
}
outside press "$source/examples/press"
outside core "$source/tests/house/outside"
"$place/core/outside"

export PKG_CONFIG_PATH="$place/prefix/lib/pkgconfig"
[ -f "$PKG_CONFIG_PATH/pellicle.pc" ] || fail "no pellicle.pc in lib/pkgconfig"
[ "$(pkg-config --modversion pellicle)" = "$(sed -n 's/.*PEL_VERSION "\(.*\)"/\1/p' "$source/include/pellicle/base.h")" ] ||
    fail "pellicle.pc and base.h have different versions"
# shellcheck disable=SC2046
for form in "" --static; do
    "$CC" "$source/examples/press/main.c" $(pkg-config $form --cflags --libs pellicle) -o "$place/press-c"
    "$CXX" "$source/tests/house/outside/core.cpp" $(pkg-config $form --cflags --libs pellicle) -o "$place/core-cxx"
done
"$place/core-cxx"

# both builds of the example print the same: a force at the deepest point (line 4), none at the end (line 12)
"$place/press/press" | tee "$place/press.txt"
"$place/press-c" | cmp - "$place/press.txt"
awk '/force/ { force[NR] = $7 } END { exit !(NR == 12 && force[4] > 0 && force[12] == 0) }' "$place/press.txt" ||
    fail "the force on the ball does not rise and fall"

if [ -f "$PKG_CONFIG_PATH/pellicle-scene.pc" ]; then
    outside scene "$source/tests/house/outside" -DSCENE=ON
    "$place/scene/outside"
    # shellcheck disable=SC2046
    "$CXX" "$source/tests/house/outside/scene.cpp" $(pkg-config --cflags --libs pellicle-scene) -o "$place/scene-cxx"
    "$place/scene-cxx"
fi
if [ -x "$place/prefix/bin/pellicle" ]; then
    "$place/prefix/bin/pellicle" --version
    for scene in "$place"/prefix/share/pellicle/scenes/*.yaml; do
        quietly "$place/prefix/bin/pellicle" check "$scene"
    done
    bash -n "$place/prefix/share/bash-completion/completions/pellicle"
fi
