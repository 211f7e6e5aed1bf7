"""Checks the table of walks through a small city, and makes the report of walks from it.

    walks_test.py OUT
"""
import pages


class Walks(pages.Pages):
    def test_no_system_shows_a_wrong_pixel(self):
        rows = [row for row in self.rows("walks/walks") if row["varied"] == "system"]
        self.assertEqual(len(rows), 5)
        for row in rows:
            self.assertEqual(row["images"], "3")
            self.assertEqual([row[kind] for kind in ("missing_pixels", "wrong_pixels", "extra_pixels")], ["0", "0", "0"], row["system"])

    def test_each_step_draws_less(self):
        triangles = {row["system"]: float(row["mean_triangles"]) for row in self.rows("walks/walks") if row["varied"] == "system"}
        self.assertGreater(triangles["everything"], triangles["frustum"])
        self.assertGreaterEqual(triangles["frustum"], triangles["frustum-levels"])
        self.assertGreater(triangles["frustum-levels"], triangles["vlod"])
        self.assertEqual(triangles["cell-lists"], triangles["vlod"])

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("walks", 3, ("frustum-levels", "nvme", "nearly 30"))


if __name__ == "__main__":
    pages.main()
