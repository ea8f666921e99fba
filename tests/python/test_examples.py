"""The examples, as functions and as programs."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from common import ROOT, is_single, long

EXAMPLES = ROOT / "examples/python"
sys.path.insert(0, str(EXAMPLES))

import inflate
import press
import surrogate


class Examples(unittest.TestCase):
    def test_press(self):
        depths, forces, residuals = press.press()
        self.assertAlmostEqual(depths[-1], 0.012)
        self.assertTrue(all(b > a for a, b in zip(forces, forces[1:])))
        self.assertLess(max(residuals), (1e-3 if is_single() else 1e-5) * forces[-1])

    def test_inflate(self):
        stretches, pressures = inflate.inflate(frequency=6, steps=14)
        expected = inflate.closed_form(stretches)
        # the ball has flat triangles
        self.assertLess(abs(pressures / expected - 1).max(), 0.005)
        top = pressures.argmax()
        self.assertTrue(0 < top < len(pressures) - 1)
        self.assertAlmostEqual(stretches[top], 1.48, delta=0.05)

    @long
    @unittest.skipIf(is_single(), "in float the table is another one")
    def test_surrogate(self):
        with tempfile.TemporaryDirectory() as folder:
            mean, largest = surrogate.main(folder)
        self.assertLess(mean, 0.005)
        self.assertLess(largest, 0.02)

    @long
    def test_a_picture_is_optional(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "press.png")
            command = [sys.executable, str(EXAMPLES / "press.py"), str(path)]
            result = subprocess.run(command, env=dict(os.environ), check=True, capture_output=True, text=True)
            self.assertEqual(path.is_file(), "matplotlib is not installed" not in result.stdout)
            self.assertIn("12.00 mm", result.stdout)


if __name__ == "__main__":
    unittest.main()
