"""Execute a study of 200 runs, and train a small neural network in numpy on its table.

    build/venv/bin/python examples/python/surrogate.py

The network has one hidden layer. It is trained with Adam (Kingma, Ba, 2015) on 160 runs and tested on the other 40.
"""

import pathlib
import sys

import numpy as np
import pellicle

STUDY = pathlib.Path(__file__).resolve().parents[1] / "studies/indent.yaml"
INPUTS = ["bodies.ball.springs.stiffness", "bodies.ball.volumetric.stiffness"]


def learn(inputs, outputs, hidden=24, rounds=6000, seed=0):
    """A function that predicts outputs (n,) from inputs (n, k). Both must be scaled to standard deviation 1."""
    draw = np.random.default_rng(seed)
    weights = [draw.standard_normal((inputs.shape[1], hidden)), np.zeros(hidden), draw.standard_normal(hidden) / hidden**0.5, 0.0]
    first, second = [0 * w for w in weights], [0 * w for w in weights]
    for n in range(1, rounds + 1):
        layer = np.tanh(inputs @ weights[0] + weights[1])
        error = (layer @ weights[2] + weights[3] - outputs) / len(outputs)
        back = np.outer(error, weights[2]) * (1 - layer**2)
        slopes = [inputs.T @ back, back.sum(axis=0), layer.T @ error, error.sum()]
        rate = 0.02 * (1 - n / (rounds + 1))
        for i, slope in enumerate(slopes):
            first[i] = 0.9 * first[i] + 0.1 * slope
            second[i] = 0.999 * second[i] + 0.001 * slope**2
            step = (first[i] / (1 - 0.9**n)) / (np.sqrt(second[i] / (1 - 0.999**n)) + 1e-8)
            weights[i] = weights[i] - rate * step
    return lambda x: np.tanh(x @ weights[0] + weights[1]) @ weights[2] + weights[3]


def main(folder):
    table = pellicle.sweep(STUDY, folder)
    inputs = np.log(np.column_stack([table[name] for name in INPUTS]))
    inputs = (inputs - inputs.mean(axis=0)) / inputs.std(axis=0)
    depth = table["depth"]
    scaled = (depth - depth.mean()) / depth.std()
    train, test = np.arange(200) % 5 != 4, np.arange(200) % 5 == 4
    predict = learn(inputs[train], scaled[train])
    error = np.abs(predict(inputs[test]) - scaled[test]) * depth.std() / depth[test]
    return float(error.mean()), float(error.max())


if __name__ == "__main__":
    mean, largest = main(sys.argv[1] if len(sys.argv) > 1 else "results/surrogate")
    print(f"depth in the 40 test runs: mean error {100 * mean:.2f} %, largest error {100 * largest:.2f} %")
