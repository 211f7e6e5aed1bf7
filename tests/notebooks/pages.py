"""What the tests of notebooks and reports share. Each is run as TEST OUT on the tables that make_tables.py made in the folder OUT."""
import csv
import os
import pathlib
import re
import subprocess
import sys
import unittest

import nbformat
from nbclient import NotebookClient

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = pathlib.Path(sys.argv[1])


def told(name):
    """What a command printed."""
    return (OUT / "told" / f"{name}.txt").read_text()


class Pages(unittest.TestCase):
    def rows(self, table):
        with open(OUT / f"{table}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def execute(self, name, images, expected):
        """Executes a notebook, which must draw so many images and say all that is expected."""
        notebook = nbformat.read(ROOT / f"notebooks/{name}.ipynb", as_version=4)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook.cells), "committed with outputs")
        self.assertFalse([cell.source for cell in notebook.cells if cell.source.isalpha()], "words still to be written")
        os.environ["VISMAT_OUT"] = str(OUT)
        os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # three lines of warning for each notebook
        NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(ROOT / "notebooks")}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pages = "".join(output.data.get("text/html", "") for output in outputs if "data" in output)
        for word in expected:
            self.assertTrue(word in pages, word)
        self.assertEqual(sum("image/png" in output.get("data", {}) for output in outputs), images)

    def report(self, name, images, expected):
        """Runs a report. Its text and page must say all that is expected, the page needs no other file, and all tables are kept."""
        folder, records = OUT / name, OUT / "results" / name
        text = subprocess.run([sys.executable, ROOT / f"bench/reproduce/{name}_report.py", OUT, records], check=True, capture_output=True, text=True).stdout
        page = (folder / "report.html").read_text()
        for word in expected:
            self.assertIn(word, text)
            self.assertIn(word, page)
        sources = re.findall(r'(?:src|href)="([^"]{0,30})', page)
        self.assertEqual(len(sources), images)
        self.assertEqual(len(list(folder.glob("*.png"))), images)
        self.assertTrue(all(source.startswith("data:image/png;base64,") for source in sources), sources)
        for table in [*folder.glob("*.csv"), folder / f"{name}.txt"]:
            kept = (records / table.name).read_text()
            self.assertTrue(kept.startswith("# machine: "), kept[:80])
            self.assertTrue(kept.endswith(table.read_text()))


def main():
    unittest.main(argv=sys.argv[:1])
