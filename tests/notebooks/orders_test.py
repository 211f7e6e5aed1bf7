"""Has small matrices ordered and measured by every program that the notebook reads from, and executes the notebook and
bench/layout_report.py on that. Walks need a level, which is in no repository, so theirs is written here.

    orders_test.py VISMAT FOLDER_OF_BENCH_PROGRAMS
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
METHODS = ("identity", "random", "lexicographic", "morton", "greedy", "exact-tour", "sampled-tour", "bisection", "polished-tour", "best")


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def walk():
    lines = ["matrix,layout,page_bytes,read_ahead_pages,steps,reads,bytes_read,bytes_wanted"]
    for page in (4096, 65536):
        lines += [f"tiny,{layout},{page},1,100,{reads},{reads * page},400000" for layout, reads in (("identity", 500), ("random", 1000), ("best", 400))]
    return "\n".join(lines) + "\n"


class Orders(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        layout = cls.out / "layout"
        layout.mkdir()
        matrices = [cls.out / f"{name}.bsp.h5" for name in ("artificial-1", "tiny.cells")]
        for seed, matrix in enumerate(matrices):
            run(VISMAT, "city", "--size", 8, "--seed", seed + 1, "-o", cls.out / "city.scene.h5")
            run(VISMAT, "see", cls.out / "city.scene.h5", "--producer", "climbing", "-o", matrix)
        cls.table = run(BENCH / "orders", "--out", layout, *matrices)
        run(BENCH / "orders", "--out", layout, "--append", "--side", "rows", matrices[0])
        run(BENCH / "distance_statistics", "--out", layout, "--trials", 5, "--scale", 0.001, *matrices)
        for scale in (0.0005, 0.001):
            run(BENCH / "order_scale", "--scale", scale, "--csv", layout / f"scale_power-plant_{scale}.csv")
        run(BENCH / "order_failures", "--out", layout, "--scale", 0.001, "--columns", 40, "--seeds", 3, "--queries", 10, matrices[0])
        run(BENCH / "flann_recall", "--rows", 256, "--density", 0.05, "--columns", 200, "--queries", 20, "--csv", layout / "flann_recall.csv")
        (layout / "disk_walk.csv").write_text(walk())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_table_names_every_method_and_the_bound(self):
        for expected in (*METHODS, "no order has fewer than"):
            self.assertIn(expected, self.table)

    def test_no_order_is_below_its_bound(self):
        lines = [line.split(",") for line in (self.out / "layout" / "orders.csv").read_text().splitlines()]
        head, rows = lines[0], [dict(zip(lines[0], line)) for line in lines[1:]]
        self.assertGreaterEqual(len(rows), 3 * (len(METHODS) - 1))
        for row in rows:
            self.assertEqual(len(row), len(head))
            self.assertGreaterEqual(float(row["runs"]), float(row["bound"]), row)
            self.assertGreater(float(row["bound"]), 0, row)
        fewest = {key: min(float(r["runs"]) for r in rows if (r["matrix"], r["side"]) == key) for key in {(r["matrix"], r["side"]) for r in rows}}
        for row in rows:
            if row["method"] == "best":
                self.assertLessEqual(float(row["runs"]), 1.03 * fewest[row["matrix"], row["side"]])

    def test_notebook_draws_all_charts(self):
        notebook = nbformat.read(ROOT / "notebooks/orders.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        self.assertFalse([cell.source for cell in notebook.cells if cell.source.isalpha()], "words still to be written")
        os.environ["VISMAT_OUT"] = str(self.out)
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        for expected in (*METHODS, "artificial 1", "tiny", "prototype", "511,631", "64.0%"):
            self.assertTrue(expected in pages, expected)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), 9)

    def test_report_needs_no_other_file_and_is_kept(self):
        text = run(sys.executable, ROOT / "bench/layout_report.py", self.out, self.out / "results")
        page = (self.out / "layout.html").read_text()
        for expected in ("artificial 1", "polished-tour", "64.0%", "60.0%"):
            self.assertIn(expected, text)
            self.assertIn(expected, page)
        sources = re.findall(r'(?:src|href)="([^"]{0,30})', page)
        self.assertEqual(len(sources), len(list((self.out / "layout").glob("*.png"))))
        self.assertTrue(all(source.startswith("data:image/png;base64,") for source in sources), sources)
        for table in (self.out / "layout").glob("*.csv"):
            kept = (self.out / "results" / table.name).read_text()
            self.assertTrue(kept.startswith("# machine: "), kept[:80])
            self.assertTrue(kept.endswith(table.read_text()))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
