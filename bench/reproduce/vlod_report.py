"""The report on compressed differences and rows: Table 2 and Figs. 9 and 14 of Chhugani et al. 2005, and the size and speed of every
codec: text, charts, one page.

    bench/reproduce/vlod_report.py [OUT [RECORDS]]   reads the tables that ./reproduce vlod wrote to OUT/vlod, writes report.html,
                                                     vlod.txt and the charts beside them, prints the text, and keeps text
                                                     and tables in RECORDS

The notebooks import the same functions. Nothing here measures: every figure is read or a quotient of two that are.
"""
import pathlib
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy
import pandas as pd

import report_tools as tools
from report_tools import BLUE, GREEN, GREY, LIGHT_BLUE, LIGHT_GREY, ORANGE, RED, bare, legend_below, panels, plain_ticks

PLAIN = {"bit masks", "ids of 32 bits", "pairs of 32 bits", "lzw of 32 bits"}
ORDERS = {"random": "random", "printed": "published method", "best": "best"}  # that of section 6.1


@dataclass
class Results:
    """The tables as the verbs of bench and `vismat compare` wrote them, and the published figures."""
    codes: pd.DataFrame            # bench vlod-tables: differences, a line for each code
    compare: pd.DataFrame          # vismat compare
    distinct: pd.DataFrame | None  # vismat compare --distinct
    failures: pd.DataFrame         # bench row-failures
    walk: pd.DataFrame | None      # bench walk-deltas
    published: pd.Series


def load(out):
    read = tools.tables_of(pathlib.Path(out) / "vlod")
    return Results(*map(read, ("codes", "compare", "compare_distinct", "failures", "walk")), tools.published("vlod2005").set_index("figure"))


def with_ratios(compare):
    """The table of vismat compare and what follows from it: ratio to the bitmap, bits for each entry, rates."""
    table = compare.copy()
    table["bitmap"] = table.rows * ((table["columns"] + 7) // 8)
    table["ratio"] = table.bitmap / table.bytes
    table["bits"] = 8 * table.bytes / table.ones
    table["gb_s"] = table.bitmap / 1e9 / table.decode_s
    table["ids_s"] = table.ones / table.decode_s
    table["encode_mb_s"] = table.bitmap / 1e6 / table.encode_s
    return table


# ---- tables ----------------------------------------------------------------------------------------------------------------

IDS, PAIRS = "ids of 32 bits:\ntimes smaller\nthan bit masks", "pairs of 32 bits:\ntimes smaller\nthan bit masks"
DELIMITER, OVERALL = "delimiter:\ntimes smaller\nthan pairs", "delimiter:\ntimes smaller\nthan bit masks"
LZW_32, LZW = "delimiter:\nsmaller than LZW\nof 32 bits by", "delimiter:\nsmaller than LZW\nof varints by"


def table_2(results):
    """Ours beside the published figures: how many times smaller pairs are than bit masks, and the delimiter code than pairs."""
    words = results.published.words
    rows = [{"differences": "UNC power plant", "order": "published", "density": "about 0.5 %", "ids per\nrun": "about 2.8",
             IDS: words.ids_over_bitmask, PAIRS: words.pairs_over_bitmask, DELIMITER: words.delimiter_over_pairs, OVERALL: words.overall,
             LZW_32: words.smaller_than_lzw, LZW: "", "times as fast\nto decode\nas LZW": words.times_faster_than_lzw,
             "bytes per\ndifference": words.bytes_a_difference, "us to\ndecode one": words.decode_us}]
    for (matrix, order), group in results.codes.groupby(["matrix", "order"], sort=False):
        of = group.set_index("code")
        first, delimiter, lzw = group.iloc[0], of.loc["delimiter"], of.loc["pair-lzw"]
        pairs = of.bytes["pairs of 32 bits"]
        rows.append({"differences": matrix, "order": ORDERS[order], "density": f"{first.ones / first.rows / first['columns']:.2%}",
                     "ids per\nrun": f"{first.ones / first.runs:.2f}",
                     IDS: f"{first.bitmask_bytes / of.bytes['ids of 32 bits']:.2f}", PAIRS: f"{first.bitmask_bytes / pairs:.2f}",
                     DELIMITER: f"{pairs / delimiter.bytes:.2f}", OVERALL: f"{first.bitmask_bytes / delimiter.bytes:.1f}",
                     LZW_32: f"{1 - delimiter.bytes / of.bytes['lzw of 32 bits']:.0%}", LZW: f"{1 - delimiter.bytes / lzw.bytes:.0%}",
                     "times as fast\nto decode\nas LZW": f"{lzw.decode_us / delimiter.decode_us:.1f}",
                     "bytes per\ndifference": f"{delimiter.bytes / first.differences:,.0f}", "us to\ndecode one": f"{delimiter.decode_us:.2f}"})
    return pd.DataFrame(rows)


def tables_of_codes(results, order="best"):
    """Every code on the same pairs, with a table for each matrix of differences."""
    tables = {}
    for matrix, group in results.codes[results.codes.order == order].groupby("matrix", sort=False):
        first = group.iloc[0]
        rows = [{"code": row.code, "bytes": f"{row.bytes:,.0f}", "times smaller\nthan bit masks": f"{first.bitmask_bytes / row.bytes:.1f}x",
                 "bits\nper id": f"{8 * row.bytes / row.ones:.2f}", "bytes per\ndifference": f"{row.bytes / row.differences:,.1f}",
                 "us to\nencode": "" if row.code in PLAIN else f"{row.encode_us:.2f}", "us to\ndecode": "" if row.code in PLAIN else f"{row.decode_us:.2f}",
                 "least to most\nus to decode": "" if row.code in PLAIN else f"{row.decode_us_least:.2f} to {row.decode_us_most:.2f}"} for row in group.itertuples()]
        tables[f"{matrix}: {first.differences:,.0f} differences over {first['columns']:,} columns in the order {order}"] = pd.DataFrame(rows)
    return tables


COMPARED = {"bytes": ("bytes", "{:,.0f}"), "ratio to the bitmap": ("ratio", "{:.2f}"), "bits per visible entry": ("bits", "{:.3f}"),
            "encode, MB/s of bitmap": ("encode_mb_s", "{:,.1f}"), "decode, GB/s of bitmap": ("gb_s", "{:.3f}"),
            "decode, M ids/s": ("ids_s", "{:,.0f}"), "one row, us, median": ("row_p50_us", "{:.2f}"), "one row, us, 99th percentile": ("row_p99_us", "{:.2f}")}


def blocks_of_comparison(compare, measures=tuple(COMPARED)):
    """Codecs by matrices and orders, a table for each measure; the bytes of the orders stand on a line of their own."""
    table = with_ratios(compare)
    names = list(dict.fromkeys(zip(table.matrix, table.order)))
    blocks = {}
    for measure in measures:
        column, form = COMPARED[measure]
        scale = 1e-6 if column == "ids_s" else 1
        cells = table.set_index(["codec", "matrix", "order"])[column]
        rows = []
        for codec in dict.fromkeys(table.codec):
            row = {"codec": codec}
            for matrix, order in names:
                value = cells.get((codec, matrix, order), numpy.nan)
                row[f"{matrix}\n{order}".replace(", distinct", "\ndistinct")] = "-" if pd.isna(value) else form.format(value * scale)
            rows.append(row)
        if measure == "bytes":
            rows.append({"codec": "(order of rows and columns)"} | {f"{m}\n{o}".replace(", distinct", "\ndistinct"):
                        f"{table[(table.matrix == m) & (table.order == o)].permutation_bytes.iloc[0]:,.0f}" for m, o in names})
        blocks[measure] = pd.DataFrame(rows)
    return blocks


def table_of_failures(results):
    """Bytes of a row as a share of its bitmap, a line for each codec."""
    wide = results.failures.pivot_table(index="codec", columns="row", values="of_bitmap", sort=False)
    slowest = results.failures.loc[results.failures.groupby("codec", sort=False).decode_us.idxmax()].set_index("codec")
    return pd.DataFrame([{"codec": codec} | {row: f"{share:.3f}" for row, share in shares.items()} |
                         {"slowest row": f"{slowest.row[codec]}", "us": f"{slowest.decode_us[codec]:.2f}"} for codec, shares in wide.iterrows()])


# ---- charts ----------------------------------------------------------------------------------------------------------------

COLOURS = {"ours": BLUE, "paper": RED, "baseline": GREY}  # by a codec's origin


def front(table):
    """The codecs that no other beats in both ratio and speed, by falling speed."""
    best, keep = 0, []
    for row in table.sort_values("ids_s", ascending=False).itertuples():
        if row.ratio > best:
            best = row.ratio
            keep.append(row.Index)
    return table.loc[keep]


def label_apart(axes, labels, size=6.5):
    """Texts beside their points, moved down until none covers another; labels: (x, y, text, colour). The axes' limits must stand."""
    points = 72 / axes.figure.dpi
    placed = []
    for x, y, text, colour in sorted(labels, key=lambda label: -label[1]):
        at_x, at_y = axes.transData.transform((x, y)) * points
        left, width, low = at_x + 4, .62 * size * len(text), at_y + 2
        while any(left < other + other_width and other < left + width and abs(low - other_low) < size for other, other_width, other_low in placed):
            low -= 1
        placed.append((left, width, low))
        line = dict(arrowstyle="-", linewidth=.4, color=colour, shrinkA=0, shrinkB=2) if at_y - low > size else None
        axes.annotate(text, (x, y), xytext=(4, low - at_y), textcoords="offset points", fontsize=size, color=colour, arrowprops=line)


def draw_pareto(results, columns=2, matrices=None):
    """A panel for each matrix; a codec that decodes at less than a hundredth of the fastest rate is drawn at the left edge."""
    table = with_ratios(results.compare)
    table = table[table.decode_s > 0]
    matrices = matrices or list(dict.fromkeys(table.matrix))
    all_labels = []
    figure, all_axes = panels(len(matrices), columns, 7.2, 5.2)
    for axes, matrix in zip(all_axes, matrices):
        of = table[table.matrix == matrix]
        last = of.order.iloc[-1]
        of = of.assign(ids_s=of.ids_s.clip(lower=of.ids_s.max() / 100))
        before, after = of[of.order == of.order.iloc[0]].set_index("codec"), of[of.order == last].set_index("codec")
        labels = []
        for codec, row in after.iterrows():
            rows = not pd.isna(row.row_p50_us)
            colour = COLOURS[row.origin]
            if codec in before.index and before.order.iloc[0] != last:
                axes.plot([before.ids_s[codec] / 1e6, row.ids_s / 1e6], [before.ratio[codec], row.ratio], color=colour, linewidth=.6, alpha=.35, zorder=1)
            axes.plot(row.ids_s / 1e6, row.ratio, marker="o" if rows else "s", markersize=6, color=colour, markerfacecolor=colour if rows else "white", zorder=3)
            labels.append((row.ids_s / 1e6, row.ratio, codec, colour))
        edge = front(after.reset_index())
        axes.step(edge.ids_s / 1e6, edge.ratio, where="pre", color="black", linewidth=1, linestyle=":", zorder=2)
        axes.set(xscale="log", yscale="log", xlabel="decoding speed, million visible entries per second (slower codecs at the left edge)", ylabel="times smaller than the bitmap")
        plain_ticks(axes.yaxis, "x", (1, 2, 3, 5))
        plain_ticks(axes.xaxis, "", (1, 2, 5))
        all_labels.append((axes, labels))
        first = of.iloc[0]
        axes.set_title(f"{matrix}: {first.rows:,} x {first['columns']:,}, {first.ones / first.rows / first['columns']:.1%} visible", fontsize=10, loc="left")
    figure.canvas.draw()  # settles the layout
    for axes, labels in all_labels:
        label_apart(axes, labels)
    handles = [plt.Line2D([], [], color=BLUE, marker="o", linestyle="", label="ours, any row alone"),
               plt.Line2D([], [], color=RED, marker="o", linestyle="", label="published methods, any row alone"),
               plt.Line2D([], [], color=RED, marker="s", markerfacecolor="white", linestyle="", label="published methods, whole file"),
               plt.Line2D([], [], color=GREY, marker="o", linestyle="", label="codecs in common use, any row alone"),
               plt.Line2D([], [], color=GREY, marker="s", markerfacecolor="white", linestyle="", label="codecs in common use, whole file"),
               plt.Line2D([], [], color="black", linestyle=":", label="no codec is both smaller and faster"),
               plt.Line2D([], [], color=GREY, linewidth=.6, label="from the natural order to the best one")]
    legend_below(figure, handles, 3, fontsize=8)
    return figure


def draw_table_2(results):
    """How many times smaller than bit masks each code makes the differences, by order."""
    codes = results.codes
    matrices = list(dict.fromkeys(codes.matrix))
    figure, all_axes = panels(len(matrices), 3, 4.6, 5, grid=False, sharey=True)
    for axes, matrix in zip(all_axes, matrices):
        of = codes[(codes.matrix == matrix) & (codes.code != "bit masks")]
        names = list(dict.fromkeys(of.code))[::-1]
        for i, (order, look) in enumerate({"random": LIGHT_GREY, "printed": LIGHT_BLUE, "best": BLUE}.items()):
            group = of[of.order == order].set_index("code").reindex(names)
            axes.barh(numpy.arange(len(names)) - .27 + .27 * i, group.bitmask_bytes / group.bytes, height=.26, color=look, label=f"order: {ORDERS[order]}")
        axes.axvline(results.published.published.overall, color=RED, linewidth=1, linestyle="--", label="published, delimiter code")
        axes.axvline(results.published.published.pairs_over_bitmask, color=RED, linewidth=1, linestyle=":", label="published, pairs of 32 bits")
        axes.set(yticks=range(len(names)), yticklabels=names, xscale="log", xlabel="times smaller than bit masks")
        axes.set_title(f"{matrix}, {of.ones.iloc[0] / of.rows.iloc[0] / of['columns'].iloc[0]:.2%} dense", fontsize=10, loc="left")
        plain_ticks(axes.xaxis, "x", (1, 2, 5))
    legend_below(figure, all_axes[0].get_legend_handles_labels()[0], 5, fontsize=8)
    return figure


def draw_walk(results, codecs=("delimiter", "pair-lzw", "gzip-rows", "roaring")):
    """Bytes of both lists at each boundary of a walk, as in Figs. 9 and 14 of the paper."""
    walk = results.walk
    places = list(dict.fromkeys(walk.matrix))
    figure, all_axes = plt.subplots(len(places), 2, figsize=(12, 2.7 * len(places)), squeeze=False, layout="constrained", width_ratios=(2, 1))
    for (along, spread), place in zip(all_axes, places):
        of = walk[walk.matrix == place]
        first = of[of.step <= 200]
        along.fill_between(first.step, first.delimiter, step="mid", color=BLUE, alpha=.8, linewidth=0)
        along.axhline(of.delimiter.mean(), color="black", linewidth=.8, linestyle=":")
        along.annotate(f"mean of all {len(of):,}: {of.delimiter.mean():,.0f} bytes", (1, of.delimiter.mean()), xytext=(2, 3), textcoords="offset points", fontsize=8,
                       bbox=dict(facecolor="white", edgecolor="none", alpha=.8, pad=1))
        along.set(ylabel="bytes, delimiter code", xlabel="boundary (the first 200)", xlim=(0, 200))
        along.set_title(place, fontsize=10, loc="left")
        for codec, colour in zip(codecs, (BLUE, ORANGE, GREY, GREEN)):
            if codec in of:
                spread.plot(numpy.sort(of[codec]), numpy.linspace(0, 100, len(of)), color=colour, label=codec, linewidth=1.2)
        spread.axvline(results.published.published.bytes_a_difference, color=RED, linewidth=1, linestyle="--", label="limit of the published mean")
        spread.set(xscale="symlog", xlabel="bytes of a difference", ylabel="boundaries that take less, %")
        spread.set_xscale("symlog", linthresh=10)
        spread.legend(fontsize=7, frameon=False)
        for axes in (along, spread):
            bare(axes)
            axes.grid(alpha=.25)
    return figure


def draw_failures(results):
    """The bytes of worst-case rows, by codec and kind of row."""
    wide = results.failures.pivot_table(index="codec", columns="row", values="of_bitmap", sort=False)
    figure, axes = plt.subplots(figsize=(1.05 * len(wide.columns) + 2, .3 * len(wide) + 1.6), layout="constrained")
    image = axes.imshow(numpy.log2(wide.clip(lower=2**-7)), cmap="RdBu_r", vmin=-4, vmax=4, aspect="auto")
    for (i, j), value in numpy.ndenumerate(wide.to_numpy()):
        axes.text(j, i, f"{value:.2g}", ha="center", va="center", fontsize=7, color="white" if abs(numpy.log2(max(value, 2**-7))) > 2.5 else "black")
    axes.set(xticks=range(len(wide.columns)), yticks=range(len(wide)))
    axes.set_xticklabels([name.replace(" ", "\n", 1) for name in wide.columns], fontsize=8)
    axes.set_yticklabels(wide.index, fontsize=8)
    axes.set_xlabel("kind of row")
    bar = figure.colorbar(image, ax=axes, shrink=.7, ticks=[-4, -2, 0, 2, 4])
    bar.ax.set_yticklabels(["1/16", "1/4", "1", "4", "16"])
    bar.set_label("bytes, in multiples of the bitmap")
    return figure


CHARTS = {
    "pareto": ("Ratio against decoding speed, with a panel for each matrix and a mark for each codec. Codecs with a filled mark read single rows", draw_pareto, []),
    "table_2": ("Table 2 of Chhugani et al. 2005 on our differences: how many times smaller than bit masks, by the order of the columns", draw_table_2, []),
    "walk": ("Figs. 9 and 14 of Chhugani et al. 2005: bytes of the differences along a walk, and their distribution", draw_walk, ["walk"]),
    "failures": ("Bytes of a row of 8192 columns, by kind of row, in multiples of its bitmap", draw_failures, []),
}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """A <b>difference</b> holds what appears and what vanishes between two view cells that touch: two lists of ids, which are stored as
<b>pairs</b> of a gap and a run length in one of several codes. <b>Ids of 32 bits</b> store each column number in 4 bytes, <b>pairs of 32
bits</b> each gap and each run length. <b>Bit masks</b> take one bit for each column. Times are medians on one core for
decoding all rows one after another into one buffer; <b>one row</b> is the time of a single row, read in shuffled order. Bytes are the payload and
the row index. The bytes of the <b>order of rows and columns</b> stand on a line of their own, since a scene whose view cells and objects
may be renumbered needs none. Published figures are in italics."""


def sections(results):
    """As report_tools.as_text wants them."""
    yield ("Differences: Table 2", "Our figures beside the published ones. The ratios depend on the density of the lists and on the ids per run: where both are near "
           "those of the paper, the ratios are too. The published method of ordering is that of section 6.1. A small power plant is denser than the whole, since the boundary of a region grows like the root of its area.",
           [("", table_2(results)), "table_2", *tables_of_codes(results).items()])
    yield ("Ratio against decoding speed", "Whole-file compressors decode everything at once; the other codecs decode any row alone.", ["pareto"])
    yield "Every codec on every matrix", "", list(blocks_of_comparison(results.compare).items())
    if results.distinct is not None:
        yield ("Equal columns stored once", "Faces of a level that are seen from the same view cells become one column; the line with the order of rows and columns includes the map from faces to columns.",
               list(blocks_of_comparison(results.distinct, ("bytes", "ratio to the bitmap")).items()))
    if results.walk is not None:
        yield "Along a walk", "A viewer walks from view cell to view cell, always to one that touches; the chart shows the bytes that it loads at each boundary.", ["walk"]
    yield ("Worst-case rows", "Our codecs store a row as its bitmap where a code would be larger, so no row takes more than its bitmap.", ["failures", ("Bytes as a share of the 1024 bytes of the bitmap, and the row that is slowest to decode", table_of_failures(results))])


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "vlod", "Differences and rows, compressed", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
