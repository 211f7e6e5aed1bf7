"""Has a small dense city seen at two efforts, and executes the notebook on that and on a table of one scene.

    visibility_test.py VISMAT FOLDER_OF_BENCH_PROGRAMS
"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import nbformat
from nbclient import NotebookClient

ROOT = pathlib.Path(__file__).resolve().parents[2]
VISMAT, BENCH = sys.argv[1], pathlib.Path(sys.argv[2])


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


class Visibility(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        pictures = cls.out / "visibility/pictures"
        pictures.mkdir(parents=True)
        run(VISMAT, "dense-city", "--size", 4, "-o", pictures / "city.scene.h5")
        cls.told = {}
        for effort in (0, 1):
            name = pictures / f"city.effort{effort}"
            cls.told[effort] = run(VISMAT, "see", pictures / "city.scene.h5", "--cells", "grid:4,4,1.5", "--region", "36,36,1,44,44,2.5", "--effort", effort, "-o",
                                   f"{name}.bsp.h5", "--seen", f"{name}.seen.bsp.h5")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_all_three_states_are_told(self):
        for told in self.told.values():
            for state in ("seen", "undecided", "hidden"):
                self.assertIn(f"\n  {state} ", told)

    def test_notebook_draws_what_there_is(self):
        notebook = nbformat.read(ROOT / "notebooks/visibility.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        os.environ["VISMAT_OUT"] = str(self.out)
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        self.assertIn("city", pages)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), 3)

    def test_nothing_that_a_ray_sees_is_hidden(self):
        table = self.out / "tables.csv"
        run(BENCH / "visibility_tables", "--csv", table, "--places", 1, "--cells", 1, "tilted-boxes")
        with open(table, newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["wrongly_hidden"]]
        self.assertGreater(len(rows), 5)
        self.assertTrue(all(float(row["wrongly_hidden"]) == 0 for row in rows))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
