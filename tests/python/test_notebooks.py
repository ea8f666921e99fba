"""The notebooks of examples/notebooks, run from the first to the last cell."""

import json
import os
import pathlib
import shutil
import tempfile
import unittest

from common import ROOT, SCENES, is_single, long

try:
    import nbclient
    import nbformat
    from jupyter_client.kernelspec import KernelSpecManager
except ImportError:
    nbclient = None

NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))


class Notebooks(unittest.TestCase):
    def test_are_there_without_outputs(self):
        self.assertEqual([path.stem for path in NOTEBOOKS], ["balloon", "fit", "press", "study", "surrogate"])
        for path in NOTEBOOKS:
            for cell in json.loads(path.read_text())["cells"]:
                if cell["cell_type"] == "code":
                    self.assertEqual((path.name, cell["outputs"], cell["execution_count"]), (path.name, [], None))

    @long
    @unittest.skipIf(nbclient is None, "no nbclient: install python3-nbclient and python3-ipykernel to run the notebooks")
    @unittest.skipIf("LD_PRELOAD" in os.environ, "a kernel does not start under the sanitizer")
    @unittest.skipIf(is_single(), "in float the tables and fits are others")
    def test_run(self):
        if "python3" not in KernelSpecManager().find_kernel_specs():
            self.skipTest("no kernel: install python3-ipykernel to run the notebooks")
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            shutil.copytree(ROOT / "examples", folder / "examples")
            (folder / "scenes").mkdir()
            shutil.copy(SCENES / "sphere-press.yaml", folder / "scenes")
            # a debugger in the kernel warns about frozen modules
            os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")
            # two of them show the same study, which is done once
            for path in NOTEBOOKS:
                with self.subTest(notebook=path.name):
                    notebook = nbformat.read(path, as_version=4)
                    resources = {"metadata": {"path": str(folder / "examples/notebooks")}}
                    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=resources).execute()
                    shown = [o for cell in notebook.cells for o in cell.get("outputs", []) if "text/html" in o.get("data", {})]
                    self.assertEqual(len(shown), 1 if path.stem in ("balloon", "press", "study") else 0)


if __name__ == "__main__":
    unittest.main()
