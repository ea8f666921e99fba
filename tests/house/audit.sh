#!/usr/bin/env bash
# tools/audit-symbols: a program that needs libc alone has a tag, one that needs another library is refused.
# usage: audit.sh SOURCE C_COMPILER
set -euo pipefail
source=$1 compiler=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "error: $*" >&2; exit 1; }
echo 'int main(void) { return 0; }' >"$place/plain.c"
printf '#include <zlib.h>\nint main(void) { return zlibVersion()[0] == 0; }\n' >"$place/zlib.c"
printf '#define _GNU_SOURCE\n#include <pthread.h>\nint main(void) { return pthread_create(0, 0, 0, 0); }\n' >"$place/thread.c"
"$compiler" "$place/plain.c" -o "$place/plain"
"$compiler" "$place/zlib.c" -lz -o "$place/zlib"
"$compiler" "$place/thread.c" -pthread -o "$place/thread"
tag=$("$source/tools/audit-symbols" "$place/plain")
[[ $tag =~ ^manylinux_2_([0-9]+)_ ]] || fail "the tag of a plain program is $tag"
both=$("$source/tools/audit-symbols" "$place/plain" "$place/thread")
newest=$(objdump -p "$place/thread" "$place/plain" | grep -oE 'GLIBC_2\.[0-9]+' | sort -t. -k2 -n | tail -n 1)
[[ $both == "manylinux_2_${newest#*.}_"* ]] || fail "the tag of both is $both, and the newest symbol $newest"
! "$source/tools/audit-symbols" "$place/plain" "$place/zlib" 2>"$place/said" || fail "a program that needs zlib has a tag"
grep -q 'needs libz.so.1' "$place/said" || fail "not said: needs libz.so.1"
