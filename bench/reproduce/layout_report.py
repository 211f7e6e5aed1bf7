"""The report on orders of columns and rows, with lower bounds and published figures beside ours: text, charts, one page.

    bench/reproduce/layout_report.py [OUT [RECORDS]]   reads the tables that ./reproduce layout wrote to OUT/layout, writes report.html,
                                                       layout.txt and the charts beside them, prints the text, and keeps
                                                       text and tables in RECORDS

Nothing here or in the tables and charts measures: every figure is read or a quotient of two that are.
"""
import report_tools as tools
from layout_charts import CHARTS
from layout_tables import (blocks_of_orders, load, table_of_alpha, table_of_paper, table_of_recall, table_of_scale, table_of_seeds,
                           table_of_walk)

HOW_TO_READ = """A run is a maximal group of ones in a row: it costs a disk seek, or a pair of numbers in a code. <b>Fewer than random</b> compares an
order with the mean over all orders, which is known exactly. <b>Above the bound</b> compares it with a proven lower bound on the runs of any
order (the bound of Held and Karp up to 30,000 distinct columns), so the best possible order is at most that much better. Each order is made in
a process of its own, up to five times within two seconds; <b>seconds</b> is the median of elapsed time, and <b>peak memory</b> includes the
matrix. A star marks the fewest runs. The columns of a level are its view cells (NAME.cells; Quake calls them clusters) or its faces
(NAME.faces). Published figures are in italics."""


WALK = """A viewer walks through a level from a view cell to one that touches it. A face that appears and is not in memory is read from the disk,
where the faces lie in the given order. One read continues over unwanted pages, up to the number that the read-ahead allows. In
brackets: how many fewer reads than in a random order of the faces; more where it is negative."""


def sections(results):
    """As report_tools.as_text wants them."""
    rows = results.matrices("rows")
    yield "Orders of columns", "", [*blocks_of_orders(results).items(), "runs_against_seconds", "gap_against_seconds", "bound_convergence"]
    if rows:
        yield "Orders of rows", "The same methods on the transposed matrix, and the greedy order among touching cells of Zach and Karner 2003 (neighbours).", \
            [*blocks_of_orders(results, "rows").items()]
    yield ("At the size of the paper", "How many fewer runs than a random order two methods leave: sampled-tour, which is that of Chhugani et al. 2005, and "
           "scale-tour, which is ours; in brackets the seconds. The scenes are synthetic and imitate those of the paper; they are calibrated so that the "
           "published method reaches about its published reduction.",
           [("", table_of_paper(results)), ("", table_of_scale(results)), "scale"])
    yield ("Distances between points", "Points are distinct columns, since an equal column would be a nearest neighbour at distance 0. Alpha is "
           "the share of the other points that lie within twice the distance of the nearest one, as a mean over random points. By the paper's rule the "
           "sample size is proportional to 1 / alpha; the last column shows how many times larger it would have to be on our data than in the paper.", [("", table_of_alpha(results)), "distances"])
    if results.walk is not None:
        yield "Disk reads on a walk", WALK, [("", table_of_walk(results)), "walk"]
    yield ("Where orders fail", "", ["failures_shapes", "failures_samples", ("Spread over random seeds", table_of_seeds(results)),
                                      ("Share of the ten nearest columns that sketches find (nearby_points)", table_of_recall(results)), "failures_flann"])


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "layout", "Orders of columns and rows, with lower bounds", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
