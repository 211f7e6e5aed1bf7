"""The report on row codecs: bytes of every codec that gives any row alone, and of its rivals, by families of matrices, with the speed
of rows and the goals: text, a chart, one page.

    bench/reproduce/rows_report.py [OUT [RECORDS]]   reads the tables that ./reproduce rows wrote to OUT/rows, writes report.html,
                                                     rows.txt and the chart beside them, prints the text, and keeps text and
                                                     tables in RECORDS

Nothing here measures: every figure is read, or a quotient or a mean of what is read. Codecs come from the tables; only goals name them.
"""
import pathlib
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy
import pandas as pd

import report_tools as tools
import rows_study
from report_tools import BLUE, GREY, RED, legend_below, panels, plain_ticks
from vlod_report import COLOURS, label_apart

# By the last part of a matrix's name.
FAMILIES = {"cells": "cells x cells", "faces": "cells x faces", "octants": "view cells\nx octants", "deltas": "differences", "sectors": "Doom\nsectors", "see": "objects\nby see"}
ARTIFICIAL = "artificial\ncities"
MAIN = [FAMILIES[name] for name in ("cells", "faces", "octants")]


@dataclass
class Results:
    """The tables as `vismat compare` and verbs of bench wrote them; codecs with their families and ratios."""
    best: pd.DataFrame                # vismat compare, best order
    speed: pd.DataFrame | None        # bench row-speed
    ablation: pd.DataFrame | None     # bench row-study: bytes without parts of the method
    bits: pd.DataFrame | None         # bench row-study: bytes by what they are spent on
    sensitivity: pd.DataFrame | None  # bench row-study: wrong orders, wrong entries
    training: pd.DataFrame | None     # bench train-rows: bytes without contexts

    @property
    def families(self):
        present = set(self.best.family)
        return [family for family in [*FAMILIES.values(), ARTIFICIAL] if family in present]


def family_of(matrix):
    return FAMILIES.get(matrix.rpartition(".")[2], ARTIFICIAL)


def load(out):
    read = tools.tables_of(pathlib.Path(out) / "rows")
    natural, best = read("natural"), read("best")

    def bytes_of(table, codec):
        of = table[table.codec == codec].set_index("matrix").bytes
        return best.matrix.map(of)

    best["family"] = best.matrix.map(family_of)
    best["alone"] = best.row_p50_us.notna()
    best["of_zpaq"] = best.bytes / bytes_of(natural, "zpaq")
    for rival, column in (("xz", "of_xz"), ("quake-rle", "of_quake"), ("roaring", "of_roaring")):
        best[column] = best.bytes / bytes_of(best, rival)
    best["ids_s"] = best.ones / best.decode_s
    return Results(best, *map(read, ("speed", "ablation", "bits", "sensitivity", "training")))


def mean(values):
    """The geometric mean; NaN without values or where one is not known."""
    values = numpy.asarray(values, dtype=float)
    return numpy.exp(numpy.log(values).mean()) if len(values) and (values > 0).all() else numpy.nan


def by_family(results, column, alone=None):
    """Geometric means of a column, a line for each codec and a column for each family; NaN where a codec is not for all of its matrices."""
    table = results.best if alone is None else results.best[results.best.alone == alone]
    number = results.best.groupby("family").matrix.nunique()
    means = {(codec, family): mean(of[column]) if of.matrix.nunique() == number[family] else numpy.nan for (codec, family), of in table.groupby(["codec", "family"])}
    return pd.Series(means, dtype=float).unstack().reindex(columns=results.families)


# ---- tables ----------------------------------------------------------------------------------------------------------------

def matrices_of(results):
    """What was measured."""
    first = results.best.drop_duplicates("matrix")
    rows = []
    for family in results.families:
        of = first[first.family == family]
        visible = of.ones / of.rows / of["columns"]
        rows.append({"family": family.replace("\n", " "), "matrices": len(of), "rows": f"{of.rows.min():,} .. {of.rows.max():,}", "columns": f"{of['columns'].min():,} .. {of['columns'].max():,}",
                     "visible": f"{visible.min():.1%} .. {visible.max():.1%}", "bytes of the order,\nmedian": f"{of.permutation_bytes.median():,.0f}"})
    return pd.DataFrame(rows)


def table_by_family(results, column, form="{:.3f}", alone=None):
    """Geometric means, the smallest codec first within each origin."""
    means = by_family(results, column, alone)
    origin = results.best.drop_duplicates("codec").set_index("codec").origin
    rank = numpy.log(means).mean(axis=1)
    order = sorted(means.index, key=lambda codec: (list(COLOURS).index(origin[codec]), rank[codec]))
    return pd.DataFrame([{"codec": codec, "from": origin[codec], **{family: "-" if pd.isna(value) else form.format(value) for family, value in means.loc[codec].items()}} for codec in order])


def table_of_speed(results):
    """M ids a second in sequence and the 99th percentile of single rows in us, geometric means."""
    ids, p99 = by_family(results, "ids_s", alone=True) / 1e6, by_family(results, "row_p99_us", alone=True)
    both = lambda codec, family: "-" if pd.isna(ids[family][codec]) else f"{ids[family][codec]:,.0f}; {p99[family][codec]:.2f}"
    order = p99.mean(axis=1).sort_values().index
    return pd.DataFrame([{"codec": codec, **{family: both(codec, family) for family in results.families}} for codec in order])


def table_of_forms(results):
    """Single rows in random order by bench row-speed, checked before they are timed."""
    rows = []
    for (matrix, codec), of in results.speed.groupby(["matrix", "codec"], sort=False):
        by = of.set_index("form")
        rows.append({"matrix": matrix, "codec": codec, **{f"{form}:\nus for a row": f"{by.row_us[form]:.3f}" for form in by.index},
                     "ids: M ids/s": f"{by.ids_s['ids'] / 1e6:,.0f}" if "ids" in by.index else "-", "bits:\nGB/s of bitmap": f"{by.gb_s['bits']:.2f}" if "bits" in by.index else "-"})
    return pd.DataFrame(rows)


# ---- goals -----------------------------------------------------------------------------------------------------------------

@dataclass
class Goal:
    codec: str
    what: str
    limit: float
    reached: callable  # of Results and the codec's lines
    least: bool = False  # whether the limit is the least rather than the most

    def line(self, results, of):
        value = self.reached(results, of)
        unknown = value is None or pd.isna(value)
        met = "" if unknown else "yes" if (value >= self.limit if self.least else value <= self.limit) else "no"
        return {"codec": self.codec, "goal": self.what, "": "at least" if self.least else "at most", "limit": f"{self.limit:g}", "reached": "not measured" if unknown else f"{value:.3g}", "met": met}


def family_mean(family, column):
    return lambda results, of: mean(of[of.family == family][column])


def main_mean(column):
    """Over the three main families, each of which counts alike."""
    return lambda results, of: mean([mean(of[of.family == family][column]) for family in MAIN if (of.family == family).any()])


def wide(of):
    """Rows of some 2,400 columns."""
    return of[of.family.isin(MAIN) & of["columns"].between(1200, 4800)]


def form_mean(form, column):
    def reached(results, of):
        if results.speed is None:
            return None
        return mean(results.speed[(results.speed.codec == of.codec.iloc[0]) & (results.speed.form == form)][column])

    return reached


def goals():
    zpaq = "bytes of zpaq, natural order: "
    bytes_of = {"rows-small": ((.66, .245, .92), .57), "rows-quick": ((.70, .265, 1.0), .60)}
    for codec, (limits, deltas) in bytes_of.items():
        for family, limit in zip(MAIN, limits):
            yield Goal(codec, zpaq + family.replace("\n", " "), limit, family_mean(family, "of_zpaq"))
        yield Goal(codec, zpaq + "differences", deltas, family_mean(FAMILIES["deltas"], "of_zpaq"))
    yield Goal("rows-small", "bytes of xz -9e, same order", .75, main_mean("of_xz"))
    yield Goal("rows-small", "any row, p99, us", 60, lambda results, of: mean(wide(of).row_p99_us))
    yield Goal("rows-small", "M ids/s in sequence", 100, lambda results, of: mean(wide(of).ids_s) / 1e6, least=True)
    yield Goal("rows-quick", "any row, p99, us", 20, lambda results, of: mean(wide(of).row_p99_us))
    yield Goal("rows-quick", "M ids/s where rows have 300 ids", 150, lambda results, of: mean(of[of.family.isin(MAIN) & (of.ones >= 300 * of.rows)].ids_s) / 1e6, least=True)
    yield Goal("rows-quick", "a boundary, its two rows at p99, us", 5, lambda results, of: 2 * mean(of[of.family == FAMILIES["deltas"]].row_p99_us))
    for codec, quake in (("rows-fast-ids", .39), ("rows-fast-bits", .44)):
        yield Goal(codec, "bytes of Quake RLE, same order", quake, main_mean("of_quake"))
        yield Goal(codec, "any row, p99, us", 1, lambda results, of: mean(wide(of).row_p99_us))
    yield Goal("rows-fast-ids", "bytes of Roaring, same order", .55, main_mean("of_roaring"))
    yield Goal("rows-fast-ids", "G ids/s in sequence", 3, lambda results, of: mean(wide(of).ids_s) / 1e9, least=True)
    yield Goal("rows-fast-bits", "GB/s of bitmap", 10, form_mean("bits", "gb_s"), least=True)


def table_of_goals(results):
    """A line for each goal of a codec that was measured."""
    lines = sorted(goals(), key=lambda goal: ("rows-small", "rows-quick", "rows-fast-ids", "rows-fast-bits").index(goal.codec))
    of = dict(list(results.best.groupby("codec")))
    return pd.DataFrame([goal.line(results, of[goal.codec]) for goal in lines if goal.codec in of])


# ---- the chart -------------------------------------------------------------------------------------------------------------

def draw_front(results, columns=2):
    """Bytes against the time of a row, a panel for each family; the whole-file codecs that are smallest as lines."""
    all_p99, all_bytes = by_family(results, "row_p99_us", alone=True), by_family(results, "of_zpaq")
    origin = results.best.drop_duplicates("codec").set_index("codec").origin
    figure, all_axes = panels(len(results.families), columns, 7.2, 5.8)
    all_labels = []
    for axes, family in zip(all_axes, results.families):
        points = pd.DataFrame({"x": all_p99[family], "y": all_bytes[family]}).dropna()
        for codec, x, y in points.itertuples():
            axes.plot(x, y, marker="o", markersize=6, color=COLOURS[origin[codec]])
        edge = [y for _, y in sorted(zip(points.x, points.y))]
        axes.step(sorted(points.x), numpy.minimum.accumulate(edge), where="post", color="black", linewidth=1, linestyle=":")
        whole = all_bytes[family].drop(index=all_p99.index).dropna().nsmallest(3)
        for codec, y in whole.items():
            axes.axhline(y, color=COLOURS[origin[codec]], linewidth=.8, linestyle="--")
        axes.set(xscale="log", yscale="log", xlabel="one row, 99th percentile, us", ylabel="bytes, in multiples of zpaq's")
        axes.set_title(f"{family} ({results.best[results.best.family == family].matrix.nunique()})".replace("\n", " "), fontsize=10, loc="left")
        plain_ticks(axes.yaxis, "", (1, 2, 5))
        plain_ticks(axes.xaxis, "", (1,) if points.x.max() > 1e4 * points.x.min() else (1, 2, 5))
        axes.margins(x=.18)
        all_labels.append((axes, [(x, y, codec, COLOURS[origin[codec]]) for codec, x, y in points.itertuples()] +
                           [(axes.get_xlim()[0], y, codec, COLOURS[origin[codec]]) for codec, y in whole.items()]))
    figure.canvas.draw()  # settles the layout
    for axes, labels in all_labels:
        label_apart(axes, labels)
    handles = [plt.Line2D([], [], color=colour, marker="o", linestyle="", label=label) for colour, label in ((BLUE, "ours"), (RED, "published methods"), (GREY, "in common use"))]
    handles += [plt.Line2D([], [], color="black", linestyle=":", label="no codec is both smaller and faster"),
                plt.Line2D([], [], color=GREY, linestyle="--", linewidth=.8, label="the three smallest whole-file codecs, same order")]
    legend_below(figure, handles, 5, fontsize=8)
    return figure


CHARTS = {"rows_front": ("Bytes against the time of a single row by families of matrices, geometric means over each family's matrices. The order of rows and columns is the best one", draw_front, ["best"]),
          **rows_study.CHARTS}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """A <b>row codec</b> gives the visible objects of any one view cell without decoding the rest. Every codec here had the same
matrix in the order best of rows and columns, and each payload was decoded and compared. <b>Of zpaq</b> divides its bytes by those of
zpaq -m5 on the bitmap in the natural order, which has all of the file to look at. Rows and columns are renumbered, and the bytes of the
order are not counted. All figures are geometric means over the matrices of a family; a dash means that a codec is not for all of them.
Times are those of one core, of rows in shuffled order into one buffer: <b>p99</b> is the time that one row in a hundred exceeds."""


def sections(results):
    """As report_tools.as_text wants them."""
    yield "Matrices", "", [("", matrices_of(results))]
    reached = table_of_goals(results)
    if len(reached):
        yield ("Goals", "Bytes and speeds are geometric means; a goal on speed counts matrices of 1,200 to 4,800 columns of the first three families.", [("", reached)])
    yield "Bytes against the time of a row", "", ["rows_front"]
    yield ("Bytes by family", "", [("Codecs that give any row alone: bytes, of those of zpaq -m5 in the natural order", table_by_family(results, "of_zpaq", alone=True)),
                                   ("Codecs of the whole file: the same", table_by_family(results, "of_zpaq", alone=False)),
                                   ("Codecs that give any row alone: bytes, of those of xz -9e in the same order", table_by_family(results, "of_xz", alone=True)),
                                   ("Bytes, of those of Quake's run lengths in the same order", table_by_family(results, "of_quake", alone=True)),
                                   ("Bytes, of those of Roaring in the same order", table_by_family(results, "of_roaring", alone=True))])
    forms = [("Single rows in random order, checked as they are read, by the form in which they are asked for", table_of_forms(results))] if results.speed is not None else []
    yield "Speed", "", [("Million ids a second in sequence; a single row in us, 99th percentile", table_of_speed(results)), *forms]
    yield from rows_study.sections(results)


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "rows", "Rows", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
