#!/usr/bin/env bash
# tools/macos on small sources: what macOS has passes, and so does what portable/macos gives it; what it lacks fails with file and name, declared or not.
# usage: macos.sh SOURCE_DIR
set -euo pipefail
cd "$1"
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cat >"$place/good.c" <<'C'
#include <stdio.h>
#include <time.h>
#include <unistd.h>
int work(void);
int work(void) { return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, NULL, NULL) + puts("done") + (int)sysconf(_SC_PAGESIZE); }
C
printf 'int clock_nanosleep(int, int, void *, void *);\nint work(void);\nint work(void) { return clock_nanosleep(0, 0, 0, 0); }\n' >"$place/declared.c"
printf '#include <unistd.h>\nint work(void);\nint work(void) { return syncfs(0); }\n' >"$place/unknown.c"
printf '#include <sys/epoll.h>\n' >"$place/header.c"
tools/macos "$place/good.c"
# fails NAME TEXT...: the check has to fail with all texts
fails() {
    local name=$1 said
    shift
    ! said=$(tools/macos "$place/$name.c" 2>&1) || { echo "$name.c passes"; exit 1; }
    for text in "$@"; do grep -qF "$text" <<<"$said" || { echo "$name.c does not say '$text': $said"; exit 1; }; done
}
fails declared declared.c.o _clock_nanosleep 'an alternative in portable/macos'
fails unknown unknown.c:3 "'syncfs'" portable/macos/declarations
fails header header.c:1 sys/epoll.h
