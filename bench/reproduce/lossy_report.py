"""The report on merging, clusters and subsets: Table 3 of Zach and Karner 2003, bytes against added entries, and where
merging fails: text, charts, one page.

    bench/reproduce/lossy_report.py [OUT [RECORDS]]   reads the tables that ./reproduce lossy wrote to OUT/lossy, writes report.html,
                                                      lossy.txt and the charts beside them, prints the text, and keeps
                                                      text and tables in RECORDS

Nothing here or in the tables and charts measures: every figure is read, or a sum or quotient of what is read.
"""
import report_tools as tools
from lossy_charts import CHARTS
from lossy_tables import (load, seeds_against_pairs, table_3, table_at_extra, table_of_cells, table_of_dense, table_of_every_level,
                          table_of_halves, table_of_loss, table_of_random, table_of_search, table_of_seeds, table_of_subsets, table_of_trees)

HOW_TO_READ = """Merged view cells share one row, which is the union of their rows. Nothing visible is ever hidden (each coded matrix was read again
and compared with its source, row by row), but some hidden objects become visible. <b>Lost</b> is the measure of the paper: the share of the
hidden entries (occlusions) that became visible. <b>Extra visible</b> counts the same entries as a share of the visible ones, which is the extra
work of a renderer. <b>Maps</b> are the bytes that say which row and column here stands for each row and column of the source: groups where a
side is merged, else an order. Curves and shares of lossless bytes include the maps; Table 3 does not, as in the paper. The matrices of
level NAME are NAME.cells, whose columns are its view cells, and NAME.faces. Matrices over the
nodes of a tree are coded by the methods of the paper after its greedy order; other matrices are coded by row codecs and whole-file codecs
after the best order of rows and columns. Published figures are in italics."""


def sections(results):
    """As report_tools.as_text wants them."""
    shown = tools.drawable(CHARTS, results)
    yield ("Table 3: the methods of Zach and Karner at 5 % lost occlusions", "In brackets: how many times smaller than the lossless table. 'Of published' is our "
           "ratio over the published one, both with Huffman codes.", [("", table_3(results))])
    yield ("Bytes against added entries", "", ["lossy_curves", *((f"Bytes with maps at {lost:.0%} lost occlusions, and their share of the bytes of the same codec without loss", table_of_halves(results, lost))
                                                         for lost in (.01, .05) if (results.curves.lost == lost).any()),
                                                       ("Bytes with maps by added entries, as a share of the smallest lossless bytes", table_at_extra(results)),
                                                       *([("Every level that Debian packages at 5 % lost occlusions: xz after the best order, both sides merged", table_of_every_level(results))]
                                                         if results.every_level is not None else [])])
    both = seeds_against_pairs(results)
    if len(both):
        yield "Merging by seeds, as in the paper, against merging by all pairs", "Both at the same loss. Seconds are of one run.", [("", both)]
    failures = []
    if "lossy_spread" in shown:
        failures += ["lossy_spread", ("Twenty random seeds", table_of_seeds(results)), ("Matrices without structure, 5 % lost occlusions", table_of_random(results))]
    if "lossy_cells" in shown:
        failures += ["lossy_cells", ("A bound on the loss of each view cell", table_of_cells(results))]
    if "lossy_broken" in shown:
        failures += ["lossy_broken", ("Dense rows", table_of_dense(results)), ("Trees", table_of_trees(results))]
    if failures:
        yield "Where merging fails", "", failures
    if "gotsman" in shown:
        yield ("Subsets over a tree of view cells: Gotsman, Sudarsky and Fayman 1999", "docs/lossy.md describes the methods and trees, and says what is published and what is ours. The last form codes the trits "
               "of the third method with context models.", ["gotsman", ("", table_of_subsets(results))])
    if "panne_search" in shown:
        yield ("Clusters: van de Panne and Stewart 1999", "The search is ours and can be stopped at any time. With loss, view cells or objects are merged first, and clusters are searched after that.", ["panne_search", ("", table_of_search(results))])
    yield "Every merge", "The losses of single view cells are shares of their own hidden entries. Bytes are those of the smallest codec; the last column includes the maps.", [("", table_of_loss(results))]


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "lossy", "Merging, clusters and subsets", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
