"""Checks small tables of orders, and executes their notebook and report.

    orders_test.py OUT
"""
import pages

METHODS = ("identity", "random", "lexicographic", "morton", "greedy", "exact-tour", "sampled-tour", "bisection", "polished-tour", "best")


class Orders(pages.Pages):
    def test_table_names_every_method_and_the_bound(self):
        for expected in (*METHODS, "no order has fewer than"):
            self.assertIn(expected, pages.told("orders"))

    def test_no_order_is_below_its_bound(self):
        rows = self.rows("layout/orders")
        self.assertGreaterEqual(len(rows), 3 * (len(METHODS) - 1))
        for row in rows:
            self.assertNotIn(None, row, "a line longer than the header")
            self.assertNotIn(None, row.values(), "a line shorter than the header")
            self.assertGreaterEqual(float(row["runs"]), float(row["bound"]), row)
            self.assertGreater(float(row["bound"]), 0, row)
        fewest = {key: min(float(r["runs"]) for r in rows if (r["matrix"], r["side"]) == key) for key in {(r["matrix"], r["side"]) for r in rows}}
        for row in rows:
            if row["method"] == "best":
                self.assertLessEqual(float(row["runs"]), 1.03 * fewest[row["matrix"], row["side"]])

    def test_notebook_draws_all_charts(self):
        self.execute("orders", 9, (*METHODS, "artificial 1", "tiny", "64.0%"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("layout", 9, ("artificial 1", "polished-tour", "64.0%", "60.0%"))


if __name__ == "__main__":
    pages.main()
