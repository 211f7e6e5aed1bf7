"""Makes two small cities, one under the name of an artificial scene and one as if a level, has them tabulated, and executes the
notebook and bench/report.py on that.

    zach2003_test.py VISMAT FOLDER_OF_BENCH_PROGRAMS
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import nbformat
from nbclient import NotebookClient

ROOT = pathlib.Path(__file__).resolve().parents[2]
VISMAT, BENCH = sys.argv[1], pathlib.Path(sys.argv[2])
PUBLISHED_GZIP = "188,018 (5.2x)"


def run(*words, **more):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **more).stdout


class Zach2003(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        for name, seed in (("artificial-1", 1), ("tiny.cells", 2)):
            run(VISMAT, "city", "--size", 8, "--seed", seed, "-o", cls.out / "city.scene.h5")
            run(VISMAT, "see", cls.out / "city.scene.h5", "--producer", "climbing", "-o", cls.out / f"{name}.bsp.h5")
        matrices = sorted(cls.out.glob("*.bsp.h5"))
        run(BENCH / "zach_tables", "--out", cls.out, *matrices)
        structure = run(sys.executable, ROOT / "bench/table_structure.py", *matrices)
        (cls.out / "zach2003_structure.csv").write_text(structure)
        (cls.out / "lossy").mkdir()
        run(BENCH / "lossy_tables", "--csv", cls.out / "lossy/curves.csv", "--lost", ".05", matrices[0])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_notebook_draws_all_tables_and_the_chart(self):
        notebook = nbformat.read(ROOT / "notebooks/zach2003.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        os.environ["VISMAT_OUT"] = str(self.out)
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        for expected in ("artificial 1", "tiny.cells", "inner city", "85", PUBLISHED_GZIP, "method 3, average run", "53,819 (18.3x)", "ours, pairs"):
            self.assertIn(expected, pages)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), 1)

    def test_report_needs_no_other_file(self):
        text = run(sys.executable, ROOT / "bench/report.py", self.out)
        page = (self.out / "report.html").read_text()
        for expected in ("artificial 1", "tiny.cells", PUBLISHED_GZIP):
            self.assertIn(expected, text)
            self.assertIn(expected, page)
        sources = re.findall(r'(?:src|href)="([^"]{0,30})', page)
        self.assertEqual(len(sources), len(list(self.out.glob("*.png"))))
        self.assertTrue(all(source.startswith("data:image/png;base64,") for source in sources), sources)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
