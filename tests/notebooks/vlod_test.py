"""Checks small tables of differences and codecs, and executes their two notebooks and the report.

    vlod_test.py OUT
"""
import pages

COLUMNS = "matrix,rows,columns,ones,order,codec,origin,bytes,permutation_bytes,encode_s,decode_s,row_p50_us,row_p99_us"


class Vlod(pages.Pages):
    def test_compare_has_every_codec_twice_a_matrix(self):
        self.assertEqual((pages.OUT / "vlod/compare.csv").read_text().splitlines()[0], COLUMNS)
        rows = self.rows("vlod/compare")
        for codec in ("delimiter", "pair-lzw", "pair-ans", "elias-fano", "gzip", "xz", "zstd", "brotli", "roaring", "streamvbyte", "zstd-dict",
                      "unreal-chunks", "quake-rle", "zpaq", "jbig1"):
            self.assertEqual(sum(row["codec"] == codec for row in rows), 4, codec)
            self.assertIn(codec, pages.told("compare"))
        for row in rows:
            self.assertEqual(row["permutation_bytes"] == "0", row["order"] == "natural", row)
            self.assertIn(row["origin"], ("ours", "paper", "baseline"))
            if row["origin"] == "ours":  # each of ours gives any row alone
                self.assertGreater(float(row["row_p99_us"]), 0, row)

    def test_no_row_codec_of_ours_is_above_the_bitmap(self):
        for row in self.rows("vlod/failures"):
            if row["codec"] in ("delimiter", "elias-fano", "bitmap") or row["codec"].startswith("pair-"):
                self.assertLessEqual(float(row["bytes"]), 1024 + 16, row)

    def test_pairs_are_as_small_as_counted(self):
        for row in self.rows("vlod/codes"):
            if row["code"] == "pairs of 32 bits":
                self.assertEqual(int(row["bytes"]), 8 * int(row["runs"]))

    def test_notebook_of_the_paper(self):
        self.execute("vlod2005", 3, ("34.2", "over 35 %", "delimiter", "alternating", "power-plant"))

    def test_notebook_of_the_front(self):
        self.execute("pareto", 1, ("bits per visible entry", "zpaq", "distinct columns"))

    def test_report_needs_no_other_file_and_is_kept(self):
        self.report("vlod", 4, ("34.2", "pair-ans", "power-plant", "alternating"))


if __name__ == "__main__":
    pages.main()
