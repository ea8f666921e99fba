#!/usr/bin/env bash
# `make demo MESH=` with a mesh that has a hole and triangles turned around: a repaired copy is pressed.
# usage: demo.sh SOURCE PROGRAM
set -euo pipefail
source=$1 program=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { cat "$place/said"; echo "error: $*" >&2; exit 1; }
cd "$place"
ln -s "$source/scenes" scenes

# the bean without its last triangle, and its first one turned around
awk '/^f/ { if (!turned++) { print "f", $2, $4, $3; next } }
     { lines[++count] = $0 }
     END { for (i = 1; i < count; ++i) print lines[i] }' "$source/tests/data/bean.obj" >broken.obj
! "$program" run "$source/scenes/organ-press.yaml" --set bodies.0.mesh='{ file: broken.obj }' -o refused >said 2>&1 ||
    fail "the broken mesh runs as it is"
"$source/tools/demo" "$program" "" broken.obj 1 y >said 2>&1 || fail "the broken mesh is not repaired"
for line in "broken.obj has errors" "triangles turned around: 1" "holes closed: 1" "results in results/broken:"; do
    grep -qF "$line" said || fail "not said: $line"
done
[ -f results/broken/summary.json ] || fail "no run"

# a sound mesh is pressed as it is
"$source/tools/demo" "$program" "" "$source/tests/data/bean.obj" 1 y >said 2>&1 || fail "the bean does not run"
! grep -qF "repaired" said || fail "the bean was repaired"
grep -qE "the body is [0-9.]+ x [0-9.]+ x [0-9.]+ m large with SCALE=1 " said || fail "the size is not told"

# no surface: the message of the check
echo "v 0 0 0" >points.obj
status=0
"$source/tools/demo" "$program" "" points.obj 1 y >said 2>&1 || status=$?
[ $status -eq 2 ] || fail "exit status $status for a file without triangles"
grep -qF "no triangles" said || fail "not said: no triangles"
