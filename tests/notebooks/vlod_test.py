"""Has small matrices measured by every program that ./reproduce vlod runs, and executes both notebooks and bench/vlod_report.py
on that.

    vlod_test.py VISMAT FOLDER_OF_BENCH_PROGRAMS
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
COLUMNS = "matrix,rows,columns,ones,order,codec,origin,bytes,permutation_bytes,encode_s,decode_s,row_p50_us,row_p99_us"


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


class Vlod(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        vlod = cls.out / "vlod"
        vlod.mkdir()
        city, differences = cls.out / "artificial-1.bsp.h5", cls.out / "artificial-1.differences.bsp.h5"
        run(VISMAT, "city", "--size", 8, "-o", cls.out / "city.scene.h5")
        run(VISMAT, "see", cls.out / "city.scene.h5", "--producer", "climbing", "-o", city)
        run(VISMAT, "deltas", city, "-o", differences)
        cls.codes = run(BENCH / "vlod_tables", "--seconds", 0, "--csv", vlod / "codes.csv", "--scale", 0.0005, "--", differences)
        cls.compared = run(VISMAT, "compare", "--seconds", 0, "--orders", "natural,best", "--csv", vlod / "compare.csv", city, differences)
        run(VISMAT, "compare", "--seconds", 0, "--distinct", "--codecs", "gzip,delimiter", "--csv", vlod / "compare_distinct.csv", city)
        run(BENCH / "row_failures", "--seconds", 0, "--csv", vlod / "failures.csv")
        run(BENCH / "walk_deltas", "--steps", 300, "--csv", vlod / "walk.csv", city)
        cls.vlod = vlod

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def rows(self, name):
        with open(self.vlod / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_compare_has_every_codec_twice_a_matrix(self):
        self.assertEqual((self.vlod / "compare.csv").read_text().splitlines()[0], COLUMNS)
        rows = self.rows("compare")
        for codec in ("delimiter", "pair-lzw", "pair-ans", "elias-fano", "gzip", "xz", "zstd", "brotli", "roaring", "streamvbyte", "zstd-dict",
                      "unreal-chunks", "quake-rle", "zpaq", "jbig1"):
            self.assertEqual(sum(row["codec"] == codec for row in rows), 4, codec)
            self.assertIn(codec, self.compared)
        for row in rows:
            self.assertEqual(row["permutation_bytes"] == "0", row["order"] == "natural", row)
            self.assertIn(row["origin"], ("ours", "paper", "baseline"))
            if row["origin"] == "ours":  # each of ours gives any row alone
                self.assertGreater(float(row["row_p99_us"]), 0, row)

    def test_no_row_codec_of_ours_is_above_the_bitmap(self):
        for row in self.rows("failures"):
            if row["codec"] in ("delimiter", "elias-fano", "bitmap") or row["codec"].startswith("pair-"):
                self.assertLessEqual(float(row["bytes"]), 1024 + 16, row)

    def test_pairs_are_as_small_as_counted(self):
        for row in self.rows("codes"):
            if row["code"] == "pairs of 32 bits":
                self.assertEqual(int(row["bytes"]), 8 * int(row["runs"]))

    def execute(self, name, images, expected):
        notebook = nbformat.read(ROOT / f"notebooks/{name}.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        os.environ["VISMAT_OUT"] = str(self.out)
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        for word in expected:
            self.assertIn(word, pages)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), images)

    def test_notebook_of_the_paper(self):
        self.execute("vlod2005", 3, ("34.2", "over 35 %", "delimiter", "alternating", "power-plant"))

    def test_notebook_of_the_front(self):
        self.execute("pareto", 1, ("bits a visible entry", "zpaq", "distinct columns"))

    def test_report_needs_no_other_file_and_is_kept(self):
        text = run(sys.executable, ROOT / "bench/vlod_report.py", self.out, self.out / "results")
        page = (self.out / "vlod.html").read_text()
        for expected in ("34.2", "pair-ans", "power-plant", "alternating"):
            self.assertIn(expected, text)
            self.assertIn(expected, page)
        sources = re.findall(r'(?:src|href)="([^"]{0,30})', page)
        self.assertEqual(len(sources), len(list(self.vlod.glob("*.png"))))
        self.assertTrue(all(source.startswith("data:image/png;base64,") for source in sources), sources)
        for table in self.vlod.glob("*.csv"):
            kept = (self.out / "results" / table.name).read_text()
            self.assertTrue(kept.startswith("# machine: "), kept[:80])
            self.assertTrue(kept.endswith(table.read_text()))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
