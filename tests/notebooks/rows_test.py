"""Checks a small matrix of view cells x octants and the tables of row codecs, and executes their report.

    rows_test.py OUT
"""
import csv
import math
import sys

import pages

sys.path.insert(0, str(pages.ROOT / "bench/reproduce"))
import rows_report

CHARTS = 5
WANTED = ("rows-small", "rows-quick", "rows-fast-ids", "rows-fast-bits")


class Rows(pages.Pages):
    def results_with(self, codecs):
        """The tables, with the lines of pair-ans once more for each of these codecs, as if it were that one."""
        rows = self.rows("rows/best")
        folder = pages.OUT / "goals/rows"
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / "best.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(row for row in rows if row["codec"] not in WANTED)
            writer.writerows(row | {"codec": codec} for codec in codecs for row in rows if row["codec"] == "pair-ans")
        (folder / "natural.csv").write_text((pages.OUT / "rows/natural.csv").read_text())
        return rows_report.load(pages.OUT / "goals")

    def test_octants_are_an_ordinary_matrix(self):
        told = " ".join(pages.told("info octants").split())
        for words in ("a column is a octant", "guarantee aggressive", "row boxes, column boxes, row neighbours", "names of columns"):
            self.assertIn(words, told)
        columns = {int(row["columns"]) for row in self.rows("rows/best") if row["matrix"] == "tiny.octants"}
        self.assertEqual(len(columns), 1)
        self.assertTrue(40 < min(columns) <= 150, columns)  # a level more would be too many, a quarter too few

    def test_octants_and_view_cells_are_as_many_as_may_be(self):
        self.assertIn("18 octants of 0.75 m", pages.told("octants of a level"))
        self.assertIn("28 view cells", pages.told("octants of a level"))

    def test_goals_appear_with_their_codecs(self):
        self.assertEqual(len(rows_report.table_of_goals(self.results_with([]))), 0)
        small = rows_report.table_of_goals(self.results_with(["rows-small"]))
        self.assertEqual(set(small.codec), {"rows-small"})
        self.assertEqual(set(rows_report.table_of_goals(self.results_with(WANTED)).codec), set(WANTED))

        natural = {row["matrix"]: int(row["bytes"]) for row in self.rows("rows/natural")}
        best = {(row["matrix"], row["codec"]): int(row["bytes"]) for row in self.rows("rows/best")}
        for matrix, family, limit in (("tiny.cells", "cells x cells", .66), ("tiny.octants", "view cells x octants", .92)):
            [line] = small[small.goal.str.endswith(f"zpaq, natural order: {family}")].to_dict("records")
            share = best[matrix, "pair-ans"] / natural[matrix]
            self.assertEqual((line["limit"], line["reached"], line["met"]), (f"{limit:g}", f"{share:.3g}", "yes" if share <= limit else "no"))
        [line] = small[small.goal.str.startswith("bytes of xz")].to_dict("records")
        shares = [best[matrix, "pair-ans"] / best[matrix, "xz"] for matrix in natural]
        self.assertEqual(line["reached"], f"{math.exp(sum(map(math.log, shares)) / 2):.3g}")
        [faces] = small[small.goal.str.endswith("cells x faces")].to_dict("records")
        self.assertEqual((faces["reached"], faces["met"]), ("not measured", ""))

    def test_means_are_of_whole_families(self):
        results = self.results_with([])
        cells = results.best.matrix == "tiny.cells"
        results.best = results.best[~(cells & (results.best.codec == "roaring"))]
        table = rows_report.table_by_family(results, "of_zpaq").set_index("codec")
        self.assertEqual(table["cells x cells"]["roaring"], "-")
        self.assertNotEqual(table["cells x cells"]["quake-rle"], "-")

    def test_bits_add_up_to_the_bytes(self):
        whole = {(row["matrix"], row["codec"]): float(row["bytes"]) for row in self.rows("rows/ablation") if row["without"] == "nothing"}
        parts = {}
        for row in self.rows("rows/bits"):
            parts.setdefault((row["matrix"], row["codec"]), []).append(float(row["bytes"]))
            self.assertGreaterEqual(float(row["bytes"]), 0, row)
        self.assertEqual(set(parts), set(whole))
        self.assertEqual(len(whole), 2)
        for key, of in parts.items():
            self.assertAlmostEqual(sum(of), whole[key], delta=.01)

    def test_parts_orders_and_entries_tell(self):
        taken = {(row["matrix"], row["codec"], row["without"]): float(row["bytes"]) for row in self.rows("rows/ablation")}
        for matrix, codec, without in taken:
            if without in ("second reference", "references", "groups"):
                self.assertGreater(taken[matrix, codec, without], taken[matrix, codec, "nothing"])
        trained = {row["without"]: int(row["small"]) for row in self.rows("rows/training")}
        self.assertNotEqual(trained["shape"], trained["nothing"])
        taken = {(row["matrix"], row["codec"], row["flipped"], row["order"]): int(row["bytes"]) for row in self.rows("rows/sensitivity")}
        for matrix, codec, flipped, order in taken:
            if codec in ("rows-small", "pair-huffman-shared"):
                best = taken[matrix, codec, "0", "best"]
                if flipped == "0" and order == "random":
                    self.assertGreater(taken[matrix, codec, flipped, order], best)
                if flipped != "0":
                    self.assertGreater(taken[matrix, codec, flipped, order], best)
                    self.assertGreater(taken[matrix, codec, "0.05", order], taken[matrix, codec, "0.01", order])

    def test_notebook_draws_all_charts(self):
        self.execute("rows", CHARTS, ("view cells x octants", "rows in the tree&#x27;s order", "where\nnew ends are", "best\nof every second row", "5.0% flipped"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("rows", CHARTS, ("view cells x octants", "pair-ans", "of those of zpaq -m5", "quake-rle"))


if __name__ == "__main__":
    pages.main()
