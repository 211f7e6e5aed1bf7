"""Has small matrices merged by every program that ./reproduce lossy runs, and executes the notebook and bench/lossy_report.py on that.

    loss_test.py VISMAT FOLDER_OF_BENCH_PROGRAMS
"""
import csv
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
CHARTS = 6


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


class Loss(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        cls.lossy = cls.out / "lossy"
        cls.lossy.mkdir()
        nodes, objects = cls.out / "artificial-1.bsp.h5", cls.out / "tiny.cells.bsp.h5"
        run(VISMAT, "city", "--size", 8, "-o", cls.out / "city.scene.h5")
        run(VISMAT, "see", cls.out / "city.scene.h5", "--producer", "climbing", "-o", nodes)
        run(VISMAT, "see", cls.out / "city.scene.h5", "--producer", "climbing", "--objects", "-o", objects)
        curves = ("--csv", cls.lossy / "curves.csv")
        cls.table = run(BENCH / "lossy_tables", *curves, "--lost", "0,.05,.2", "--codecs", "pair-ans,delimiter,panne,xz,jbig1", nodes, objects)
        run(BENCH / "lossy_tables", *curves, "--append", "--no-lossless", "--methods", "seeds", "--sides", "cells", "--lost", ".05", nodes, objects)
        cls.failures = run(BENCH / "lossy_failures", "--lost", .2, "--seeds", 3, "--size", 100, "--out", cls.lossy, objects, nodes)
        run(BENCH / "gotsman_tables", "--seconds", 0, "--csv", cls.lossy / "gotsman.csv", objects)
        run(BENCH / "panne_search", "--seconds", 0, "--csv", cls.lossy / "panne.csv", objects)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def rows(self, name):
        with open(self.lossy / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_no_merge_loses_more_than_allowed(self):
        rows = self.rows("curves")
        for row in rows:
            self.assertLessEqual(float(row["lost_share"]), float(row["lost"]), row)
            self.assertEqual(row["added"] == "0", row["lost"] == "0", row)
            self.assertLessEqual(int(row["cells"]), int(row["rows"]), row)
            if row["side"] in ("none", "cells"):
                self.assertEqual(row["objects"], row["columns"], row)
        for codec in ("zach3-huffman", "zach4-range", "pair-ans", "delimiter", "panne", "xz"):
            self.assertIn(codec, self.table)
            whole = {row["matrix"]: int(row["bytes"]) for row in rows if row["codec"] == codec and row["method"] == "none"}
            for row in rows:
                if row["codec"] == codec and row["lost"] == "0.2":
                    self.assertLess(int(row["bytes"]), whole[row["matrix"]], row)

    def test_bounds_on_single_cells_hold(self):
        for row in self.rows("failures_cells"):
            self.assertLessEqual(float(row["cell_worst"]), float(row["max_per_cell"]), row)
        for row in self.rows("failures_dense"):
            self.assertLessEqual(float(row["cell_worst"]), float(row["max_per_cell"]), row)

    def test_trees_break_where_nodes_are_merged_alone(self):
        ways = {}
        for row in self.rows("failures_trees"):
            ways[row["way"]] = ways.get(row["way"], 0) + int(row["violations"])
        self.assertEqual(len(ways), 4)
        for way, violations in ways.items():
            self.assertEqual(violations > 0, way == "nodes merged", ways)

    def test_studies_are_told(self):
        for name in ("seeds", "random", "dense", "cells", "trees"):
            self.assertIn(f"failures_{name}.csv", self.failures)

    def test_notebook_draws_all_charts(self):
        notebook = nbformat.read(ROOT / "notebooks/loss.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        os.environ["VISMAT_OUT"] = str(self.out)
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        for expected in ("smallest of these", "artificial 1", "tiny.cells", "nodes seen without", "gotsman3-context", "clusters"):
            self.assertIn(expected, pages)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), CHARTS)

    def test_report_needs_no_other_file_and_is_kept(self):
        text = run(sys.executable, ROOT / "bench/lossy_report.py", self.out, self.out / "results")
        page = (self.out / "lossy.html").read_text()
        for expected in ("53,819 (18.3x)", "ours, pairs", "gotsman3-context", "objects merged; tree over them"):
            self.assertIn(expected, text)
            self.assertIn(expected, page)
        sources = re.findall(r'(?:src|href)="([^"]{0,30})', page)
        self.assertEqual(len(sources), CHARTS)
        self.assertTrue(all(source.startswith("data:image/png;base64,") for source in sources), sources)
        for table in self.lossy.glob("*.csv"):
            kept = (self.out / "results" / table.name).read_text()
            self.assertTrue(kept.startswith("# machine: "), kept[:80])
            self.assertTrue(kept.endswith(table.read_text()))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
