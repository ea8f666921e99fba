"""Fit the Mooney-Rivlin constants of a balloon to its pressure curve.

    build/venv/bin/python examples/python/fit.py
"""

import pathlib

import pellicle

FIT = pathlib.Path(__file__).resolve().parents[1] / "fits/balloon.yaml"


def main(folder="results/balloon-fit"):
    fit = pellicle.calibrate(FIT, folder)
    young, ratio = fit.values["bodies.balloon.membrane.young"], fit.values["bodies.balloon.membrane.mooney_ratio"]
    c1 = young / 6 / (1 + ratio)
    return c1, ratio * c1


if __name__ == "__main__":
    c1, c2 = main()
    print(f"c1 = {c1:.0f} Pa (the data were generated with 181818 Pa), c2 = {c2:.0f} Pa (18182 Pa)")
