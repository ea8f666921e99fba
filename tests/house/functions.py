#!/usr/bin/env python3
"""Checks that nothing in src calls a function of the C library whose rounding differs between platforms: src/ground/math/functions.h
has those that give the same bits. sqrt, floor, rint, fmod, frexp and their like are exact. Nor does anything but
src/ground/base/clock.c read a clock.

usage: functions.py ROOT | functions.py --self-test
"""
import pathlib
import re
import sys

NAMES = "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 expm1 log log2 log10 log1p pow cbrt hypot erf erfc tgamma lgamma"
CALL = re.compile(rf"(?<![\w.>])({'|'.join(NAMES.split())})[fl]?\s*\(")
CLOCK = re.compile(r"(?<![\w.>])(clock_gettime|timespec_get|gettimeofday|clock|time)\s*\(")
CLOCK_DOOR = "src/ground/base/clock.c"
COMMENT = re.compile(r"/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"", re.S)


def calls(name, text):
    code = COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
    for number, line in enumerate(code.splitlines(), 1):
        for found in CALL.finditer(line):
            yield f"{name}:{number}: {found[1]} of the C library has other bits elsewhere; src/ground/math/functions.h has its like"
        for found in CLOCK.finditer(line) if name != CLOCK_DOOR else ():
            yield f"{name}:{number}: {found[1]} reads a clock outside {CLOCK_DOOR}; use pel_seconds"


def self_test():
    assert list(calls("a.c", "double a = sin (x);")) and list(calls("a.c", "/* b */ return -powf(x, 2);"))
    assert not list(calls("a.c", "pel_sin(x); law->exp(x); sqrt(x); /* exp(x)\n cos(y) */ s = \"tan(x)\";"))
    assert list(calls("a.c", "timespec_get(&now, TIME_UTC);")) and not list(calls(CLOCK_DOOR, "clock_gettime(clock, &now);"))
    assert not list(calls("a.c", "sim->clock(); next_time(sim); double (*clock)(void);"))
    assert [line.split(":")[1] for line in calls("a.c", "/* a\n*/\nhypot(x, y)")] == ["3"]


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    root = pathlib.Path(sys.argv[1])
    files = sorted((root / "src").rglob("*.[ch]"))
    found = [line for path in files for line in calls(path.relative_to(root).as_posix(), path.read_text())]
    print("\n".join(found) if found else "ok")
    sys.exit(1 if found or not files else 0)


main()
