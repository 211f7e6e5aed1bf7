"""Checks a small table of producers, and executes the notebook and report of visibility on it and on a dense city seen at two efforts.

    visibility_test.py OUT
"""
import pages


class Visibility(pages.Pages):
    def test_all_three_states_are_told(self):
        for effort in (0, 1):
            for state in ("seen", "undecided", "hidden"):
                self.assertIn(f"\n  {state} ", pages.told(f"effort {effort}"))

    def test_nothing_that_a_ray_sees_is_hidden(self):
        rows = [row for row in self.rows("visibility/tables") if row["wrongly_hidden"]]
        self.assertGreater(len(rows), 5)
        self.assertTrue(all(float(row["wrongly_hidden"]) == 0 for row in rows))

    def test_notebook_draws_what_there_is(self):
        self.execute("visibility", 4, ("city", "0.4 to 2.2 s"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("visibility", 1, ("0.4 to 2.2 s", "tilted-boxes"))


if __name__ == "__main__":
    pages.main()
