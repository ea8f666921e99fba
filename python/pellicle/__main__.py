"""``python3 -m pellicle calibrate FIT``: the command `pellicle calibrate` calls it."""

import sys

from .calibration import main

if __name__ == "__main__":
    if sys.argv[1:2] != ["calibrate"]:
        sys.exit("usage: python3 -m pellicle calibrate FIT [--output DIR] [--json] [--quiet]")
    sys.exit(main(sys.argv[2:]))
