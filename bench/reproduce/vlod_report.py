"""Differences and rows, compressed: paper 000's Table 2 and Figs. 9 and 14, and every codec's size against its speed: text, charts, one page.

    bench/vlod_report.py [OUT [RECORDS]]      reads the tables that ./reproduce vlod had written to OUT/vlod; writes OUT/vlod.html,
                                              OUT/vlod/vlod.txt and OUT/vlod/*.png; prints the text; keeps text and tables,
                                              machine and commit in their first lines, in RECORDS

The notebooks import the same functions. Nothing here measures: every figure is read or a quotient of two that are.
"""
import pathlib
import sys
from dataclasses import dataclass

import matplotlib

if __name__ == "__main__":
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy
import pandas as pd

import report_tools as tools
from report_tools import PUBLISHED, bare, plain_ticks, to_html

BLUE, RED, GREY = "#1f4e79", "#b03a2e", "#777777"
PLAIN = {"bit masks", "ids of 32 bits", "pairs of 32 bits", "lzw of 32 bits"}
ORDERS = {"random": "random", "printed": "as printed (6.1)", "best": "best"}


@dataclass
class Results:
    """A table of each program, as it wrote them, and the published figures."""
    codes: pd.DataFrame            # vlod_tables: differences, a line a code
    compare: pd.DataFrame          # vismat compare
    distinct: pd.DataFrame | None  # vismat compare --distinct
    failures: pd.DataFrame         # row_failures
    walk: pd.DataFrame | None      # walk_deltas; not there where no level is
    published: pd.Series


def load(out):
    folder = pathlib.Path(out) / "vlod"

    def read(name):
        return pd.read_csv(folder / f"{name}.csv", comment="#") if (folder / f"{name}.csv").exists() else None

    published = pd.read_csv(PUBLISHED / "vlod2005.csv", comment="#").set_index("figure")
    return Results(read("codes"), read("compare"), read("compare_distinct"), read("failures"), read("walk"), published)


def with_ratios(compare):
    """The table of vismat compare and what follows from it: ratio to the bitmap, bits an entry, rates."""
    table = compare.copy()
    table["bitmap"] = table.rows * ((table["columns"] + 7) // 8)
    table["ratio"] = table.bitmap / table.bytes
    table["bits"] = 8 * table.bytes / table.ones
    table["gb_s"] = table.bitmap / 1e9 / table.decode_s
    table["ids_s"] = table.ones / table.decode_s
    table["encode_mb_s"] = table.bitmap / 1e6 / table.encode_s
    return table


# ---- tables ----------------------------------------------------------------------------------------------------------------

def table_2(results):
    """Ours beside the paper's: what runs make of bit masks, and the delimiter code of runs."""
    words = results.published.words
    rows = [{"differences": "UNC power plant", "order": "published", "density": "about .5 %", "ids a run": "about 2.8",
             "ids of 32 bits\nover bit masks": words.ids_over_bitmask, "pairs of 32 bits\nover bit masks": words.pairs_over_bitmask,
             "delimiter\nover pairs": words.delimiter_over_pairs, "overall": words.overall, "smaller than LZW\n(of 32 bits) by": words.smaller_than_lzw, "than LZW\n(of varints) by": "",
             "decoded faster\nthan LZW": words.times_faster_than_lzw, "bytes a\ndifference": words.bytes_a_difference,
             "us to decode\none": words.decode_us}]
    for (matrix, order), group in results.codes.groupby(["matrix", "order"], sort=False):
        of = group.set_index("code")
        first, delimiter, lzw = group.iloc[0], of.loc["delimiter"], of.loc["pair-lzw"]
        pairs = of.bytes["pairs of 32 bits"]
        rows.append({"differences": matrix, "order": ORDERS[order], "density": f"{first.ones / first.rows / first['columns']:.2%}",
                     "ids a run": f"{first.ones / first.runs:.2f}",
                     "ids of 32 bits\nover bit masks": f"{first.bitmask_bytes / of.bytes['ids of 32 bits']:.2f}",
                     "pairs of 32 bits\nover bit masks": f"{first.bitmask_bytes / pairs:.2f}",
                     "delimiter\nover pairs": f"{pairs / delimiter.bytes:.2f}", "overall": f"{first.bitmask_bytes / delimiter.bytes:.1f}",
                     "smaller than LZW\n(of 32 bits) by": f"{1 - delimiter.bytes / of.bytes['lzw of 32 bits']:.0%}",
                     "than LZW\n(of varints) by": f"{1 - delimiter.bytes / lzw.bytes:.0%}", "decoded faster\nthan LZW": f"{lzw.decode_us / delimiter.decode_us:.1f}",
                     "bytes a\ndifference": f"{delimiter.bytes / first.differences:,.0f}", "us to decode\none": f"{delimiter.decode_us:.2f}"})
    return pd.DataFrame(rows)


def tables_of_codes(results, order="best"):
    """Every code on the same pairs, a table for each matrix of differences."""
    tables = {}
    for matrix, group in results.codes[results.codes.order == order].groupby("matrix", sort=False):
        first = group.iloc[0]
        rows = [{"code": row.code, "bytes": f"{row.bytes:,.0f}", "over\nbit masks": f"{first.bitmask_bytes / row.bytes:.1f}x",
                 "bits an id": f"{8 * row.bytes / row.ones:.2f}", "bytes a\ndifference": f"{row.bytes / row.differences:,.1f}",
                 "encode\nus": "" if row.code in PLAIN else f"{row.encode_us:.2f}", "decode\nus": "" if row.code in PLAIN else f"{row.decode_us:.2f}",
                 "least to\nmost us": "" if row.code in PLAIN else f"{row.decode_us_least:.2f} to {row.decode_us_most:.2f}"} for row in group.itertuples()]
        tables[f"{matrix}: {first.differences:,.0f} differences over {first['columns']:,} columns, order {order}"] = pd.DataFrame(rows)
    return tables


COMPARED = {"bytes": ("bytes", "{:,.0f}"), "ratio to the bitmap": ("ratio", "{:.2f}"), "bits a visible entry": ("bits", "{:.3f}"),
            "encode, MB/s of bitmap": ("encode_mb_s", "{:,.1f}"), "decode, GB/s of bitmap": ("gb_s", "{:.3f}"),
            "decode, M ids/s": ("ids_s", "{:,.0f}"), "one row, us, median": ("row_p50_us", "{:.2f}"), "one row, us, 99 of 100": ("row_p99_us", "{:.2f}")}


def blocks_of_comparison(compare, measures=tuple(COMPARED)):
    """Codecs by matrices and orders, a table a measure; permutations' bytes on a line of their own below the bytes."""
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
            rows.append({"codec": "(to name the order)"} | {f"{m}\n{o}".replace(", distinct", "\ndistinct"):
                        f"{table[(table.matrix == m) & (table.order == o)].permutation_bytes.iloc[0]:,.0f}" for m, o in names})
        blocks[measure] = pd.DataFrame(rows)
    return blocks


def table_of_failures(results):
    """Bytes a row as a share of the bitmap's, a line a codec."""
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
    """A panel a matrix; what decodes at less than a hundredth of the fastest's rate stands at the left edge."""
    table = with_ratios(results.compare)
    table = table[table.decode_s > 0]
    matrices = matrices or list(dict.fromkeys(table.matrix))
    lines, all_labels = -(-len(matrices) // columns), []
    figure, all_axes = plt.subplots(lines, columns, figsize=(7.2 * columns, 5.2 * lines), squeeze=False, layout="constrained")
    for axes, matrix in zip(all_axes.flat, matrices):
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
        axes.set(xscale="log", yscale="log", xlabel="decoded, million visible entries a second; the left edge: or fewer", ylabel="times smaller than the bitmap")
        bare(axes)
        axes.grid(alpha=.25)
        plain_ticks(axes.yaxis, "x", (1, 2, 3, 5))
        plain_ticks(axes.xaxis, "", (1, 2, 5))
        all_labels.append((axes, labels))
        first = of.iloc[0]
        axes.set_title(f"{matrix}: {first.rows:,} x {first['columns']:,}, {first.ones / first.rows / first['columns']:.1%} visible", fontsize=10, loc="left")
    for axes in all_axes.flat[len(matrices):]:
        axes.set_visible(False)
    figure.canvas.draw()  # settles the layout
    for axes, labels in all_labels:
        label_apart(axes, labels)
    handles = [plt.Line2D([], [], color=BLUE, marker="o", linestyle="", label="ours, any row alone"),
               plt.Line2D([], [], color=RED, marker="o", linestyle="", label="published methods, any row alone"),
               plt.Line2D([], [], color=RED, marker="s", markerfacecolor="white", linestyle="", label="published methods, whole file"),
               plt.Line2D([], [], color=GREY, marker="o", linestyle="", label="what people use, any row alone"),
               plt.Line2D([], [], color=GREY, marker="s", markerfacecolor="white", linestyle="", label="what people use, whole file"),
               plt.Line2D([], [], color="black", linestyle=":", label="none is both smaller and faster"),
               plt.Line2D([], [], color=GREY, linewidth=.6, label="from the natural order to the best one")]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(.5, -.01), ncols=3, fontsize=8, frameon=False)
    return figure


def draw_table_2(results):
    """How much smaller than bit masks each code makes differences, by order."""
    codes = results.codes
    matrices = list(dict.fromkeys(codes.matrix))
    columns, lines = min(3, len(matrices)), -(-len(matrices) // 3)
    figure, all_axes = plt.subplots(lines, columns, figsize=(4.6 * columns, 5 * lines), sharey=True, squeeze=False, layout="constrained")
    for axes, matrix in zip(all_axes.flat, matrices):
        of = codes[(codes.matrix == matrix) & (codes.code != "bit masks")]
        names = list(dict.fromkeys(of.code))[::-1]
        for i, (order, look) in enumerate({"random": "#d0d0d0", "printed": "#8fb3d9", "best": BLUE}.items()):
            group = of[of.order == order].set_index("code").reindex(names)
            axes.barh(numpy.arange(len(names)) - .27 + .27 * i, group.bitmask_bytes / group.bytes, height=.26, color=look, label=f"order: {ORDERS[order]}")
        axes.axvline(results.published.published.overall, color=RED, linewidth=1, linestyle="--", label="published, delimiter")
        axes.axvline(results.published.published.pairs_over_bitmask, color=RED, linewidth=1, linestyle=":", label="published, pairs")
        axes.set(yticks=range(len(names)), yticklabels=names, xscale="log", xlabel="times smaller than bit masks")
        axes.set_title(f"{matrix}, {of.ones.iloc[0] / of.rows.iloc[0] / of['columns'].iloc[0]:.2%} dense", fontsize=10, loc="left")
        plain_ticks(axes.xaxis, "x", (1, 2, 5))
        bare(axes)
    for axes in all_axes.flat[len(matrices):]:
        axes.set_visible(False)
    handles, labels = all_axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(.5, -.01), ncols=5, fontsize=8, frameon=False)
    return figure


def draw_walk(results, codecs=("delimiter", "pair-lzw", "gzip-rows", "roaring")):
    """Bytes of both lists at each boundary of a walk, as Figs. 9 and 14."""
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
        along.set(ylabel="bytes, delimiter code", xlabel="boundary crossed, the first 200", xlim=(0, 200))
        along.set_title(place, fontsize=10, loc="left")
        for codec, colour in zip(codecs, (BLUE, "#ef6c00", GREY, "#558b2f")):
            if codec in of:
                spread.plot(numpy.sort(of[codec]), numpy.linspace(0, 100, len(of)), color=colour, label=codec, linewidth=1.2)
        spread.axvline(results.published.published.bytes_a_difference, color=RED, linewidth=1, linestyle="--", label="published mean, at most")
        spread.set(xscale="symlog", xlabel="bytes of a difference", ylabel="% of boundaries take less")
        spread.set_xscale("symlog", linthresh=10)
        spread.legend(fontsize=7, frameon=False)
        for axes in (along, spread):
            bare(axes)
            axes.grid(alpha=.25)
    return figure


def draw_failures(results):
    """What a row takes at worst, by codec and kind of row."""
    wide = results.failures.pivot_table(index="codec", columns="row", values="of_bitmap", sort=False)
    figure, axes = plt.subplots(figsize=(1.05 * len(wide.columns) + 2, .3 * len(wide) + 1.6), layout="constrained")
    image = axes.imshow(numpy.log2(wide.clip(lower=2**-7)), cmap="RdBu_r", vmin=-4, vmax=4, aspect="auto")
    for (i, j), value in numpy.ndenumerate(wide.to_numpy()):
        axes.text(j, i, f"{value:.2g}", ha="center", va="center", fontsize=7, color="white" if abs(numpy.log2(max(value, 2**-7))) > 2.5 else "black")
    axes.set(xticks=range(len(wide.columns)), yticks=range(len(wide)))
    axes.set_xticklabels([name.replace(" ", "\n", 1) for name in wide.columns], fontsize=8)
    axes.set_yticklabels(wide.index, fontsize=8)
    axes.set_xlabel("row")
    bar = figure.colorbar(image, ax=axes, shrink=.7, ticks=[-4, -2, 0, 2, 4])
    bar.ax.set_yticklabels(["1/16", "1/4", "1", "4", "16"])
    bar.set_label("bytes, of the bitmap's")
    return figure


CHARTS = {
    "pareto": ("Ratio against decode speed: a panel a matrix, a dot a codec; filled: any row can be read alone", draw_pareto),
    "table_2": ("Table 2 of Chhugani et al. 2005 on our differences: times smaller than bit masks, by order of the columns", draw_table_2),
    "walk": ("Figs. 9 and 14: bytes of a difference along a walk, and over all of it", draw_walk),
    "failures": ("What a row of 8192 columns takes, by kind of row; 1 is its bitmap", draw_failures),
}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """A <b>difference</b> is what appears and what vanishes between two view cells that touch: two lists of ids, as
<b>pairs</b> of a gap and a run length, in one of several codes. <b>Bit masks</b> are one bit a column. Times are medians on one core, of decoding
all rows one after another into one buffer; <b>one row</b> is a single row at a time, in shuffled order. Bytes are payload and row index; the bytes that name the
permutations stand on a line of their own, for whoever may renumber objects pays none. Published figures are in italics."""


def sections(results):
    """As report_tools.as_text wants them."""
    yield ("Differences: Table 2", "Ours beside the published. Ratios follow the density of the lists and the ids a run: where both are near the paper's, so "
           "are they. Small power plants are denser than the whole: the rim of a region grows like the root of its area.",
           [("", table_2(results)), "table_2", *tables_of_codes(results).items()])
    yield ("Ratio against decode speed", "Whole-file compressors give back everything or nothing; the others any row.", ["pareto"])
    yield "Every codec on every matrix", "", list(blocks_of_comparison(results.compare).items())
    if results.distinct is not None:
        yield ("Equal columns once", "A level's faces that are seen from the same cells are one column; the line to name the order holds the map from faces to columns.",
               list(blocks_of_comparison(results.distinct, ("bytes", "ratio to the bitmap")).items()))
    if results.walk is not None:
        yield "Along a walk", "From cell to touching cell; the bytes that a viewer loads at each boundary.", ["walk"]
    yield ("Rows that are worst", "With the escape no row of ours takes more than its bitmap.", ["failures", ("Shares of the bitmap's 1024 bytes, and the row slowest to decode", table_of_failures(results))])


def main(out="out", records=None):
    results = load(out)
    charts = {name: (caption, draw(results)) for name, (caption, draw) in CHARTS.items() if name != "walk" or results.walk is not None}
    tools.write_report(out, "vlod", "Differences and rows, compressed", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    main(*sys.argv[1:])
