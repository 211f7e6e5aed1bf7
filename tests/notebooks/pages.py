"""What the tests of notebooks and reports share. Each is run as TEST OUT on the tables that make_tables.py made in the folder OUT.
Notebooks and reports are executed in one process, one after the other, so that pandas and matplotlib are loaded once."""
import contextlib
import csv
import io
import os
import pathlib
import re
import runpy
import sys
import unittest
import unittest.mock

import matplotlib.layout_engine
import matplotlib.pyplot
import nbformat
from IPython.core.displayhook import DisplayHook
from IPython.core.displaypub import CapturingDisplayPublisher
from IPython.core.interactiveshell import InteractiveShell
from matplotlib_inline.config import InlineBackend

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "bench/reproduce"))


def told(name):
    """What a command printed."""
    return (OUT / "told" / f"{name}.txt").read_text()


class Results(DisplayHook):
    """Keeps what the last line of a cell displays beside what the cell's other lines did."""

    def write_output_prompt(self):
        pass

    def write_format_data(self, format_dict, md_dict=None):
        self.shell.display_pub.publish(format_dict, md_dict)

    def finish_displayhook(self):
        pass


class Shell(InteractiveShell):
    displayhook_class = Results

    def enable_gui(self, gui=None):
        """Charts are not shown in windows."""


def outputs_of(notebook):
    """Executes the cells in a namespace of their own. All that they display, each as a dictionary from type to data."""
    shell = Shell.instance(history_load_length=0)
    shell.history_manager.enabled = False
    shell.reset(new_session=False)
    outputs = []
    shell.display_pub = CapturingDisplayPublisher(parent=shell, outputs=outputs)
    # A report draws the same charts in full: here they are coarse, and neither laid out nor cut, which takes three drawings.
    InlineBackend.instance(parent=shell, print_figure_kwargs={"bbox_inches": None, "dpi": 40})
    with unittest.mock.patch.object(matplotlib.layout_engine.ConstrainedLayoutEngine, "execute"):
        for cell in notebook.cells:
            if cell.cell_type == "code":
                shell.run_cell(cell.source, store_history=True).raise_error()
    matplotlib.pyplot.close("all")
    return [output["data"] for output in outputs]


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
        with contextlib.chdir(ROOT / "notebooks"), contextlib.redirect_stdout(io.StringIO()):
            outputs = outputs_of(notebook)
        pages = "".join(output.get("text/html", "") for output in outputs)
        for word in expected:
            self.assertTrue(word in pages, word)
        self.assertEqual(sum("image/png" in output for output in outputs), images)

    def report(self, name, images, expected):
        """Runs a report. Its text and page must say all that is expected, the page needs no other file, and all tables are kept."""
        folder, records = OUT / name, OUT / "results" / name
        script, words = str(ROOT / f"bench/reproduce/{name}_report.py"), sys.argv
        sys.argv = [script, str(OUT), str(records)]
        try:
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                runpy.run_path(script, run_name="__main__")
        finally:
            sys.argv = words
        text, page = printed.getvalue(), (folder / "report.html").read_text()
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


def main(modules=("__main__",)):
    suite = unittest.TestSuite(map(unittest.defaultTestLoader.loadTestsFromName, modules))
    sys.exit(not unittest.TextTestRunner().run(suite).wasSuccessful())
