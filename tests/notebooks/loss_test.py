"""Checks small tables of merged matrices, and executes their notebook and report.

    loss_test.py OUT
"""
import pages

CHARTS = 6


class Loss(pages.Pages):
    def test_no_merge_loses_more_than_allowed(self):
        rows = self.rows("lossy/curves")
        for row in rows:
            self.assertLessEqual(float(row["lost_share"]), float(row["lost"]), row)
            self.assertEqual(row["added"] == "0", row["lost"] == "0", row)
            self.assertLessEqual(int(row["cells"]), int(row["rows"]), row)
            if row["side"] in ("none", "cells"):
                self.assertEqual(row["objects"], row["columns"], row)
        for codec in ("zach3-huffman", "zach4-range", "pair-ans", "delimiter", "panne", "xz"):
            self.assertIn(codec, pages.told("lossy"))
            whole = {row["matrix"]: int(row["bytes"]) for row in rows if row["codec"] == codec and row["method"] == "none"}
            for row in rows:
                if row["codec"] == codec and row["lost"] == "0.2":
                    self.assertLess(int(row["bytes"]), whole[row["matrix"]], row)

    def test_bounds_on_single_cells_hold(self):
        for row in [*self.rows("lossy/failures_cells"), *self.rows("lossy/failures_dense")]:
            self.assertLessEqual(float(row["cell_worst"]), float(row["max_per_cell"]), row)

    def test_trees_break_where_nodes_are_merged_alone(self):
        ways = {}
        for row in self.rows("lossy/failures_trees"):
            ways[row["way"]] = ways.get(row["way"], 0) + int(row["violations"])
        self.assertEqual(len(ways), 4)
        for way, violations in ways.items():
            self.assertEqual(violations > 0, way == "nodes merged", ways)

    def test_studies_are_told(self):
        for name in ("seeds", "random", "dense", "cells", "trees"):
            self.assertIn(f"failures_{name}.csv", pages.told("lossy failures"))

    def test_notebook_draws_all_charts(self):
        self.execute("loss", CHARTS, ("smallest of these", "artificial 1", "tiny.objects", "nodes seen without", "gotsman3-context", "clusters"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("lossy", CHARTS, ("53,819 (18.3x)", "ours, pairs", "gotsman3-context", "objects merged; tree over them"))


if __name__ == "__main__":
    pages.main()
