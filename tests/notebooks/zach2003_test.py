"""Executes the notebook and the report of Zach and Karner 2003 on small tables.

    zach2003_test.py OUT
"""
import pages

PUBLISHED_GZIP = "188,018 (5.2x)"


class Zach2003(pages.Pages):
    def test_notebook_draws_all_tables_and_the_chart(self):
        self.execute("zach2003", 1, ("artificial 1", "tiny.cells", "inner city", "85", PUBLISHED_GZIP, "method 3, average run", "53,819 (18.3x)", "ours, pairs"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("zach2003", 3, ("artificial 1", "tiny.cells", PUBLISHED_GZIP))


if __name__ == "__main__":
    pages.main()
