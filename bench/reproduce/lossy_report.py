"""Controlled loss, clusters and subsets: paper 002's Table 3, bytes against extra visible entries, and where merging fails: text, charts, one page.

    bench/lossy_report.py [OUT [RECORDS]]     reads the tables that ./reproduce lossy had written to OUT/lossy; writes OUT/lossy.html,
                                              OUT/lossy/lossy.txt and OUT/lossy/*.png; prints the text; keeps text and tables,
                                              machine and commit in their first lines, in RECORDS

The notebooks import the same functions. Nothing here measures: every figure is read, or a sum or quotient of what is read.
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

BLUE, RED, GREY, GREEN, ORANGE = "#1f4e79", "#b03a2e", "#777777", "#558b2f", "#ef6c00"
SIDES = {"cells": BLUE, "objects": ORANGE, "both": GREEN}
SCENES = {"artificial-1": "artificial 1", "artificial-2": "artificial 2", "inner-city": "inner city", "complete": "complete"}
TABLE_3_LOST = .05
FAR = 4 / 3  # a ratio further than this from the published one has to be explained


@dataclass
class Results:
    """A table of each program, as it wrote them, None where it was not run; and the published figures."""
    curves: pd.DataFrame            # lossy_tables: a line a merge and codec
    seeds: pd.DataFrame | None      # lossy_failures, this and the next five
    random: pd.DataFrame | None
    dense: pd.DataFrame | None
    cells: pd.DataFrame | None
    quantiles: pd.DataFrame | None
    trees: pd.DataFrame | None
    every_level: pd.DataFrame | None  # lossy_tables of all levels
    gotsman: pd.DataFrame | None    # gotsman_tables
    search: pd.DataFrame | None     # panne_search
    published: pd.DataFrame         # Table 3
    published_scenes: pd.DataFrame  # Table 1

    @property
    def matrices(self):
        return list(dict.fromkeys(self.curves.matrix))


def load(out):
    folder = pathlib.Path(out) / "lossy"

    def read(name):
        return pd.read_csv(folder / f"{name}.csv", comment="#") if (folder / f"{name}.csv").exists() else None

    curves = read("curves")
    curves["total"] = curves.bytes + curves.names_bytes
    return Results(curves, *(read(f"failures_{name}") for name in ("seeds", "random", "dense", "cells", "quantiles", "trees")),
                   read("levels"), read("gotsman"), read("panne"), pd.read_csv(PUBLISHED / "zach2003_lossy.csv", comment="#"),
                   pd.read_csv(PUBLISHED / "zach2003_scenes.csv", comment="#").set_index("matrix"))


# ---- tables ----------------------------------------------------------------------------------------------------------------

def lossless(results, matrix):
    """The lines of a matrix as it is, by codec."""
    curves = results.curves
    return curves[(curves.matrix == matrix) & (curves.method == "none")].set_index("codec")


def table_3(results):
    """The paper's table: what 5 % lost occlusions leave of view cells, and its methods' bytes (times smaller than the lossless table);
    no map of cells and no order in them, as in the paper. Ours by both groupings, with Huffman codes as the paper has and with
    the range coder."""
    rows = []
    curves = results.curves[(results.curves.lost == TABLE_3_LOST) & (results.curves.side == "cells") & (results.curves.max_per_cell == 1)]
    published = results.published.set_index(["matrix", "codec"])
    for matrix in dict.fromkeys([*results.published.matrix, *results.matrices]):
        known = matrix in published.index
        whole = results.published_scenes.view_cells.get(matrix)
        if known:
            first = published.loc[matrix]
            rows.append({"scene": SCENES[matrix], "": "published", "cells\nleft": f"{first.remaining_view_cells.iloc[0]:,}", "of": f"{whole:,.0f}",
                         "lossy table\nbytes": f"{first.bytes['lossy_table']:,}",
                         **{f"method {n}\nHuffman": f"{first.bytes[f'zach{n}']:,} ({first.ratio[f'zach{n}']:.1f}x)" for n in (3, 4)},
                         "average run\nmethod 3": f"{first.average_run['zach3']:.2f}", "average run\nmethod 4": f"{first.average_run['zach4']:.2f}"})
        of = curves[(curves.matrix == matrix) & (curves.nodes == 1)]
        if of.empty:
            continue
        table = lossless(results, matrix).table_bytes.iloc[0]
        for method, group in of.groupby("method", sort=False):
            by, one = group.set_index("codec"), group.iloc[0]
            row = {"scene": SCENES.get(matrix, matrix), "": f"ours, {method}", "cells\nleft": f"{one.cells:,}", "of": f"{one.rows:,}",
                   "lossy table\nbytes": f"{one.table_bytes:,}"}
            for n in (3, 4):
                row[f"method {n}\nHuffman"] = f"{by.bytes[f'zach{n}-huffman']:,} ({table / by.bytes[f'zach{n}-huffman']:.1f}x)"
                row[f"method {n}\nrange coder"] = f"{by.bytes[f'zach{n}-range']:,} ({table / by.bytes[f'zach{n}-range']:.1f}x)"
                row[f"average run\nmethod {n}"] = f"{by.average_run[f'zach{n}-huffman']:.2f}"
                if known:
                    row[f"of published\nmethod {n}"] = f"{table / by.bytes[f'zach{n}-huffman'] / published.ratio[matrix, f'zach{n}']:.2f}"
            if known:
                share = table / by.bytes["zach3-huffman"] / published.ratio[matrix, "zach3"]
                row["within\na third"] = "yes" if 1 / FAR <= share <= FAR else "no"
            rows.append(row)
    columns = ["scene", "", "cells\nleft", "of", "lossy table\nbytes", "method 3\nHuffman", "of published\nmethod 3", "within\na third", "method 3\nrange coder",
               "method 4\nHuffman", "of published\nmethod 4", "method 4\nrange coder", "average run\nmethod 3", "average run\nmethod 4"]
    return pd.DataFrame(rows).reindex(columns=columns).fillna("")


def table_of_halves(results):
    """At 5 % lost occlusions, every level: bytes with what names rows and columns, and as a share of the same codec's lossless bytes."""
    rows = []
    curves = results.curves[(results.curves.lost == TABLE_3_LOST) & (results.curves.method == "pairs") & (results.curves.max_per_cell == 1)]
    for matrix in results.matrices:
        base, of = lossless(results, matrix).total, curves[curves.matrix == matrix]
        totals = of.pivot_table(index="codec", columns="side", values="total", sort=False).reindex(columns=list(SIDES))
        totals.loc["smallest of these"] = totals.min()
        for codec, sides in totals.iterrows():
            whole = base.min() if codec not in base.index else base[codec]
            row = {"matrix": SCENES.get(matrix, matrix) if codec == totals.index[0] else "", "codec": codec, "lossless": f"{whole:,.0f}"}
            for side, value in sides.items():
                row[f"{side}\nmerged"] = "-" if pd.isna(value) else f"{value:,.0f}"
            for side, value in sides.items():
                row[f"of lossless\n{side}"] = "-" if pd.isna(value) else f"{value / whole:.0%}"
            row["half or\nless"] = "yes" if sides.min() <= whole / 2 else "no"
            rows.append(row)
    return pd.DataFrame(rows)


def table_of_every_level(results):
    """What 5 % lost occlusions leave of the bytes of a level's cells x cells, both sides merged, with names; by how dense and how large
    the levels are. Few occlusions are few to lose, and of a small matrix the names are half."""
    levels = results.every_level
    whole = levels[levels.method == "none"].set_index("matrix")
    merged = levels[levels.method == "pairs"].set_index("matrix")
    visible, names = whole.ones / whole.rows / whole["columns"], "names_bytes"
    share = (merged.bytes + merged[names]) / (whole.bytes + whole[names])
    payload = merged.bytes / whole.bytes
    bins = {"all": visible >= 0, "visible below 20 %": visible < .2, "20 to 40 %": visible.between(.2, .4, inclusive="left"), "40 % and more": visible >= .4,
            "view cells below 200": whole.rows < 200, "200 to 999": whole.rows.between(200, 999), "1,000 and more": whole.rows >= 1000}
    return pd.DataFrame({"levels with": name, "": f"{of.sum():,}", "half the bytes\nor less": f"{(share[of] <= .5).sum():,}",
                         "median\nof lossless": f"{share[of].median():.0%}", "without\nnames": f"{payload[of].median():.0%}"}
                        for name, of in bins.items() if of.any())


def table_at_extra(results, shares=(.01, .02, .05, .1, .2)):
    """For so many extra visible entries, the smallest codec's bytes with names as a share of the smallest lossless ones. Between the
    points of a curve its bytes are taken to fall evenly on the chart's logarithmic axis."""
    rows = []
    curves = results.curves[(results.curves.method == "pairs") & (results.curves.max_per_cell == 1)]
    for (matrix, side), group in curves.groupby(["matrix", "side"], sort=False):
        base = lossless(results, matrix).total.min()
        points = group[group.lost > 0].groupby("lost").agg(total=("total", "min"), added=("added_share", "first"))
        x, y = [0, *points.added], numpy.log([base, *points.total])
        rows.append({"matrix": SCENES.get(matrix, matrix), "merged": side} | {f"{share:.0%} extra\nvisible": f"{numpy.exp(numpy.interp(share, x, y)) / base:.0%}" if share <= x[-1] else "-"
                                                                              for share in shares})
    return pd.DataFrame(rows)


def table_of_loss(results):
    """What each merge adds, and to whom: one line a matrix, side and loss."""
    rows = []
    curves = results.curves[(results.curves.method != "none") & (results.curves.max_per_cell == 1)]
    for (matrix, method, side, lost), group in curves.groupby(["matrix", "method", "side", "lost"], sort=False):
        one, base = group.iloc[0], lossless(results, matrix).total
        least = group.loc[group.total.idxmin()]
        rows.append({"matrix": SCENES.get(matrix, matrix), "method": method, "side": side, "lost\nat most": f"{lost:.1%}", "cells\nleft": f"{one.cells:,}", "objects\nleft": f"{one.objects:,}",
                     "added": f"{one.added:,}", "extra\nvisible": f"{one.added_share:.1%}", "median\ncell": f"{one.cell_median:.1%}", "95 of 100\ncells": f"{one.cell_95:.1%}",
                     "worst\ncell": f"{one.cell_worst:.1%}", "merged\nin s": f"{one.merge_s:.2f}", "names\nbytes": f"{one.names_bytes:,}", "smallest by": least.codec,
                     "bytes": f"{least.bytes:,}", "all bytes\nof lossless": f"{least.total / base.min():.0%}"})
    return pd.DataFrame(rows)


def seeds_against_pairs(results):
    """Both groupings at the same loss: cells left, the same codec's bytes, seconds. Bytes are the smallest codec's by pairs."""
    rows = []
    curves = results.curves[(results.curves.side == "cells") & (results.curves.max_per_cell == 1)]
    for (matrix, lost), group in curves.groupby(["matrix", "lost"], sort=False):
        if set(group.method) < {"pairs", "seeds"}:
            continue
        both = {method: of.set_index("codec") for method, of in group.groupby("method")}
        codec = both["pairs"].bytes.idxmin()
        pairs, seeds = both["pairs"].loc[codec], both["seeds"].loc[codec]
        rows.append({"matrix": SCENES.get(matrix, matrix), "lost": f"{lost:.0%}", "cells left\nseeds": f"{seeds.cells:,}", "cells left\npairs": f"{pairs.cells:,}", "codec": codec,
                     "bytes\nseeds": f"{seeds.bytes:,}", "bytes\npairs": f"{pairs.bytes:,}", "pairs of\nseeds": f"{pairs.bytes / seeds.bytes:.3f}",
                     "seconds\nseeds": f"{seeds.merge_s:.2f}", "seconds\npairs": f"{pairs.merge_s:.2f}", "times\nas fast": f"{seeds.merge_s / max(pairs.merge_s, 1e-3):.1f}"})
    return pd.DataFrame(rows)


def table_of_seeds(results):
    rows = []
    for matrix, group in results.seeds.groupby("matrix", sort=False):
        pairs, seeds = group[group.method == "pairs"].iloc[0], group[group.method == "seeds"]
        rows.append({"matrix": SCENES.get(matrix, matrix), "seeds": len(seeds), "cells left\nleast": f"{seeds.cells.min():,}", "median": f"{seeds.cells.median():,.0f}",
                     "most": f"{seeds.cells.max():,}", "bytes\nleast": f"{seeds.bytes.min():,}", "bytes\nmedian": f"{seeds.bytes.median():,.0f}", "bytes\nmost": f"{seeds.bytes.max():,}",
                     "spread": f"{seeds.bytes.max() / seeds.bytes.min() - 1:.1%}", "worst cell\nleast": f"{seeds.cell_worst.min():.0%}", "worst cell\nmost": f"{seeds.cell_worst.max():.0%}",
                     "pairs\ncells": f"{pairs.cells:,}", "pairs\nbytes": f"{pairs.bytes:,}"})
    return pd.DataFrame(rows)


def table_of_random(results):
    return pd.DataFrame([{"matrix": SCENES.get(row.matrix, row.matrix), "rows": f"{row.rows:,}", "visible": f"{row.density:.1%}", "rows\nleft": f"{row.cells:,}", "rows left\nof all": f"{row.cells / row.rows:.0%}",
                          "lost": f"{row.lost_share:.1%}", "extra\nvisible": f"{row.added_share:.0%}", "lossless\nbytes": f"{row.bytes_before:,}", "bytes": f"{row.bytes:,}",
                          "of\nlossless": f"{row.bytes / row.bytes_before:.0%}", "worst\ncell": f"{row.cell_worst:.0%}"} for row in results.random.itertuples()])


def table_of_dense(results):
    return pd.DataFrame([{"matrix": row.matrix, "dense\nrows": row.dense, "ones\nin them": f"{row.share:.0%}" if row.dense else "", "method": row.method, "most\na cell": f"{row.max_per_cell:.0%}",
                          "lost\nat most": f"{row.lost:.0%}", "lost": f"{row.lost_share:.1%}", "rows\nleft": f"{row.cells:,}", "bytes": f"{row.bytes:,}", "others that lost\nmore than half": row.poisoned,
                          "median\ncell": f"{row.cell_median:.1%}", "95 of 100\ncells": f"{row.cell_95:.1%}", "worst\ncell": f"{row.cell_worst:.0%}"} for row in results.dense.itertuples()])


def table_of_cells(results):
    return pd.DataFrame([{"matrix": SCENES.get(row.matrix, row.matrix), "most\na cell": f"{row.max_per_cell:.0%}", "cells\nleft": f"{row.cells:,}", "lost": f"{row.lost_share:.1%}", "median\ncell": f"{row.cell_median:.1%}",
                          "95 of 100\ncells": f"{row.cell_95:.1%}", "worst\ncell": f"{row.cell_worst:.1%}", "bytes": f"{row.bytes:,}", "names\nbytes": f"{row.names_bytes:,}"}
                         for row in results.cells.itertuples()])


def table_of_trees(results):
    return pd.DataFrame([{"matrix": SCENES.get(row.matrix, row.matrix), "merged": row.way, "lost\nat most": f"{row.lost:.0%}", "columns\nleft": f"{row.columns_left:,}", "cells\nleft": f"{row.cells_left:,}",
                          "entries\nadded": f"{row.added:,}", "extra\nvisible": f"{row.added_share:.1%}", "nodes seen without\ntheir parent": f"{row.violations:,}",
                          "in so many\ncells": f"{row.cells_with_violations:,}"} for row in results.trees.itertuples()])


def table_of_subsets(results):
    """Gotsman's methods over trees of view cells; beside them codecs that know no tree. Payloads; the tree's bytes apart."""
    rows = []
    for (matrix, order), group in results.gotsman.groupby(["matrix", "order"], sort=False):
        for row in group.itertuples():
            third = group[(group.tree == row.tree) & (group.codec == "gotsman3")] if isinstance(row.tree, str) else group.head(0)
            rows.append({"matrix": matrix, "columns": order, "tree": row.tree if isinstance(row.tree, str) else "-", "codec": row.codec, "bytes": f"{row.payload_bytes:,}",
                         "of the third\nmethod": f"{row.payload_bytes / third.payload_bytes.iloc[0]:.0%}" if len(third) else "", "model\nin them": f"{row.model_bytes:,}", "index": f"{row.index_bytes:,}",
                         "tree\nbytes": f"{row.tree_bytes:,}", "encode\nms": f"{1e3 * row.encode_s:,.1f}", "decode\nms": f"{1e3 * row.decode_s:,.1f}",
                         **({"row us\nmedian": "", "row us\n95 of 100": "", "us along\na path": "", "bytes read\na row": ""} if pd.isna(row.row_us) else
                            {"row us\nmedian": f"{row.row_us:.2f}", "row us\n95 of 100": f"{row.row_us_95:.2f}", "us along\na path": f"{row.row_path_us:.2f}", "bytes read\na row": f"{row.row_bytes_read:,.0f}"})})
    return pd.DataFrame(rows)


def table_of_search(results):
    """First and last state of each search for clusters."""
    rows = []
    for matrix, group in results.search.groupby("matrix", sort=False):
        first, last = group.iloc[0], group.iloc[-1]
        tenth = group[group.bytes <= last.bytes + .1 * (first.bytes - last.bytes)].iloc[0]
        rows.append({"matrix": matrix, "rows": f"{first.rows:,}", "columns": f"{first['columns']:,}", "without\nclusters": f"{first.bytes:,.0f}", "at the end": f"{last.bytes:,.0f}",
                     "of it": f"{last.bytes / first.bytes:.0%}", "clusters": f"{last.clusters:,.0f}", "seconds": f"{last.seconds:.1f}", "nine tenths of the\ngain after s": f"{tenth.seconds:.1f}"})
    return pd.DataFrame(rows)


# ---- charts ----------------------------------------------------------------------------------------------------------------

LOOKS = {"pair-ans": ("-", "o"), "zach3-huffman": ("-", "o"), "zach4-huffman": (":", "s"), "jbig1": ("--", "^"), "panne": ("-.", "D")}
NOT_DRAWN = {"delimiter", "xz", "zach3-range", "zach4-range"}  # beside another line


def draw_curves(results, columns=3, matrices=None):
    """Bytes, names of rows and columns included, against what is visible beyond the truth; a panel a matrix."""
    matrices = matrices or results.matrices
    columns = min(columns, len(matrices))
    lines = -(-len(matrices) // columns)
    figure, all_axes = plt.subplots(lines, columns, figsize=(4.9 * columns, 3.9 * lines), squeeze=False, layout="constrained")
    curves = results.curves[(results.curves.method == "pairs") & (results.curves.max_per_cell == 1)]
    drawn = {}
    for axes, matrix in zip(all_axes.flat, matrices):
        base = lossless(results, matrix)
        for (side, codec), of in curves[curves.matrix == matrix].groupby(["side", "codec"], sort=False):
            if codec in NOT_DRAWN:
                continue
            line, marker = LOOKS.get(codec, ("-", "x"))
            of = of[of.lost > 0].sort_values("added_share")
            x, y = [0, *100 * of.added_share], [base.total[codec], *of.total]
            axes.plot(x, numpy.array(y) / 1e3, color=SIDES[side], linestyle=line, marker=marker, markersize=3.5, linewidth=1.2, markerfacecolor="white" if line != "-" else None)
            drawn[codec] = (line, marker)
            at = of[of.lost == TABLE_3_LOST]
            axes.plot(100 * at.added_share, at.total / 1e3, marker=marker, markersize=7, color=SIDES[side], linestyle="")
        best = base.drop(index=[codec for codec in base.index if codec in NOT_DRAWN]).total.min() / 1e3
        axes.plot(0, best, marker="*", markersize=13, color=RED, zorder=5, clip_on=False)
        axes.axhline(best, color=RED, linewidth=.7)
        axes.axhline(best / 2, color=RED, linewidth=.9, linestyle=":")
        axes.set_xscale("symlog", linthresh=2, linscale=.6)
        axes.set_yscale("log")
        axes.set(xlabel="entries added, % of the visible ones", ylabel="kB", xticks=[0, 1, 2, 5, 10, 20, 50, 100])
        axes.set_xlim(-.15, max(100, 110 * curves[curves.matrix == matrix].added_share.max()))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_locator(plt.NullLocator())
        plain_ticks(axes.yaxis, "", (1, 2, 5))
        bare(axes)
        axes.grid(alpha=.25)
        first = base.iloc[0]
        axes.set_title(f"{SCENES.get(matrix, matrix)}: {first.rows:,} x {first['columns']:,}, {first.ones / first.rows / first['columns']:.1%} visible", fontsize=9, loc="left")
    for axes in all_axes.flat[len(matrices):]:
        axes.set_visible(False)
    handles = [plt.Line2D([], [], color=RED, marker="*", markersize=11, linewidth=.7, label="smallest lossless"), plt.Line2D([], [], color=RED, linestyle=":", label="half of it"),
               *(plt.Line2D([], [], color=colour, linewidth=3, label=f"{side} merged") for side, colour in SIDES.items()),
               *(plt.Line2D([], [], color="black", linestyle=line, marker=marker, markersize=4, markerfacecolor="white" if line != "-" else None, label=codec) for codec, (line, marker) in drawn.items()),
               plt.Line2D([], [], color=GREY, marker="o", markersize=7, linestyle="", label="5 % of occlusions lost")]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(.5, -.01), ncols=6, fontsize=8, frameon=False)
    return figure


def draw_spread(results):
    """Twenty seeds of the paper's grouping beside ours; what 5 % buys by density where there is no structure."""
    figure, (spread, random) = plt.subplots(1, 2, figsize=(12, 4), layout="constrained")
    matrices = list(dict.fromkeys(results.seeds.matrix))
    for i, matrix in enumerate(matrices):
        of = results.seeds[results.seeds.matrix == matrix]
        pairs, seeds = of[of.method == "pairs"].bytes.iloc[0], of[of.method == "seeds"].bytes.sort_values().to_numpy()
        shift = i + .3 * numpy.linspace(-1, 1, len(seeds))
        spread.scatter(shift, 100 * (seeds / pairs - 1), s=16, color=BLUE, label="a seed each" if i == 0 else None)
    spread.axhline(0, color=RED, linewidth=1, label="pairs")
    spread.set(xticks=range(len(matrices)), xlim=(-.6, len(matrices) - .4), ylabel="bytes, % above those of pairs")
    spread.set_xticklabels([SCENES.get(matrix, matrix).replace(".nodes", "\nover nodes") for matrix in matrices], fontsize=8)
    spread.set_title("seeds (paper 002, 4.1), smallest to largest", fontsize=10, loc="left")
    spread.legend(fontsize=8, frameon=False)
    noise = results.random[results.random.matrix == "random"]
    random.plot(100 * noise.density, 100 * noise.bytes / noise.bytes_before, marker="o", color=GREY, label="random matrices")
    for row in results.random[results.random.matrix != "random"].itertuples():
        share = 100 * row.bytes / row.bytes_before
        random.plot(100 * row.density, share, marker="*", markersize=11, color=BLUE, linestyle="")
        random.annotate(SCENES.get(row.matrix, row.matrix), (100 * row.density, share), xytext=(-8, -3), textcoords="offset points", fontsize=8, color=BLUE, ha="right")
    random.axhline(50, color=RED, linewidth=.9, linestyle=":")
    random.set(xscale="log", xlabel="visible, %", ylabel="bytes at 5 % lost, % of lossless", ylim=(0, 100))
    plain_ticks(random.xaxis, "", (1, 2, 5))
    random.set_title("matrices without structure", fontsize=10, loc="left")
    random.legend(fontsize=8, frameon=False, loc="upper left")
    for axes in (spread, random):
        bare(axes)
        axes.grid(alpha=.25)
    return figure


def draw_cells(results):
    """Who pays: each cell's own loss from the least to the most, for several bounds; and what the bound costs."""
    matrices = list(dict.fromkeys(results.quantiles.matrix))
    figure, all_axes = plt.subplots(2, len(matrices), figsize=(4.3 * len(matrices), 6.4), squeeze=False, layout="constrained")
    shades = plt.cm.viridis(numpy.linspace(0, .85, results.quantiles.max_per_cell.nunique()))
    for (above, below), matrix in zip(all_axes.T, matrices):
        of, costs = results.quantiles[results.quantiles.matrix == matrix], results.cells[results.cells.matrix == matrix]
        for shade, (most, group) in zip(shades, of.groupby("max_per_cell", sort=False)):
            above.plot(100 * group.share_of_cells, 100 * group.lost, color=shade, label=f"{most:.0%}")
        above.set_yscale("symlog", linthresh=20)
        above.set(xlabel="% of cells lose", ylabel="at most, % of what they hid", ylim=(0, 110), yticks=[0, 5, 10, 20, 50, 100])
        above.yaxis.set_major_formatter("{x:g}")
        above.yaxis.set_minor_locator(plt.NullLocator())
        above.set_title(SCENES.get(matrix, matrix), fontsize=10, loc="left")
        below.bar(range(len(costs)), costs.bytes / 1e3, color=shades, width=.7)
        for i, row in enumerate(costs.itertuples()):
            below.text(i, row.bytes / 1e3, f"{row.lost_share:.1%}\nlost", ha="center", va="bottom", fontsize=7)
        below.set(xticks=range(len(costs)), xlabel="--max-per-cell", ylabel="kB", ylim=(0, 1.22 * costs.bytes.max() / 1e3))
        below.set_xticklabels([f"{most:.0%}" for most in costs.max_per_cell])
        for axes in (above, below):
            bare(axes)
            axes.grid(alpha=.25, axis="y")
    all_axes[0, 0].legend(title="--max-per-cell", fontsize=7, title_fontsize=7, frameon=False, loc="upper left")
    return figure


def draw_broken(results):
    """Dense rows among others, and trees over merged columns."""
    figure, (dense, trees) = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained", width_ratios=(1.15, 1))
    if results.dense is not None and len(results.dense):
        of = results.dense[results.dense.method == "pairs"]
        kinds = list(dict.fromkeys(zip(of.dense, of.share)))
        bounds = list(dict.fromkeys(zip(of.lost, of.max_per_cell)))
        for i, ((lost, most), colour) in enumerate(zip(bounds, (BLUE, "#8fb3d9", ORANGE, "#ffcc80"))):
            group = of[(of.lost == lost) & (of.max_per_cell == most)].set_index(["dense", "share"]).reindex(kinds)
            places = numpy.arange(len(kinds)) + .2 * (i - (len(bounds) - 1) / 2)
            dense.bar(places, group.bytes / 1e3, color=colour, width=.19, label=f"{lost:.0%} lost, a cell at most {most:.0%}")
            for place, row in zip(places, group.itertuples()):
                if not pd.isna(row.bytes):
                    dense.text(place, row.bytes / 1e3, f"{row.poisoned:.0f}", ha="center", va="bottom", fontsize=7)
        dense.set(xticks=range(len(kinds)), ylabel=f"kB, {of.matrix.iloc[0]}")
        dense.set_xticklabels(["none" if number == 0 else f"{number} that see{'s' if number == 1 else ''}\n{share:.0%}" for number, share in kinds], fontsize=8)
        dense.set_title("dense rows added; above a bar: other rows that lost over half", fontsize=9, loc="left")
        dense.legend(fontsize=7, frameon=False, loc="upper right")
    of = results.trees[results.trees.lost == results.trees.lost.max()]
    ways, matrices = list(dict.fromkeys(of.way)), list(dict.fromkeys(of.matrix))
    for i, (matrix, colour) in enumerate(zip(matrices, (BLUE, GREY, GREEN))):
        group = of[of.matrix == matrix].set_index("way").reindex(ways)
        places = numpy.arange(len(ways))[::-1] + .36 * ((len(matrices) - 1) / 2 - i)
        trees.barh(places, 100 * group.added_share, height=.34, color=colour, label=SCENES.get(matrix, matrix))
        for place, row in zip(places, group.itertuples()):
            if not pd.isna(row.added_share):
                trees.text(100 * row.added_share + .3, place, f"{row.violations:,.0f} without a parent", va="center", fontsize=7)
    trees.set(yticks=numpy.arange(len(ways))[::-1], xlabel="entries added over the nodes, % of the visible ones")
    trees.set_yticklabels([way.replace("; ", ";\n") for way in ways], fontsize=8)
    trees.set_xlim(0, 135 * of.added_share.max())
    trees.set_ylim(-1.1, len(ways) - .4)
    trees.set_title(f"a tree over the columns, {of.lost.max():.0%} lost", fontsize=9, loc="left")
    trees.legend(fontsize=8, frameon=False, loc="lower right", ncols=2)
    for axes in (dense, trees):
        bare(axes)
    return figure


def draw_subsets(results):
    """Gotsman's methods and the third under contexts, over both trees, beside codecs that know none; columns in the last order given."""
    of = results.gotsman[results.gotsman.order == results.gotsman.order.iloc[-1]]
    matrices = list(dict.fromkeys(of.matrix))
    columns = min(3, len(matrices))
    lines = -(-len(matrices) // columns)
    figure, all_axes = plt.subplots(lines, columns, figsize=(4.6 * columns, 3.4 * lines), squeeze=False, layout="constrained")
    looks = {"": GREY, "k-d": "#8fb3d9", "by sets": BLUE}
    for axes, matrix in zip(all_axes.flat, matrices):
        group = of[of.matrix == matrix].fillna({"tree": ""})
        names = [*dict.fromkeys(group[group.tree != ""].codec), *dict.fromkeys(group[group.tree == ""].codec)][::-1]
        trees = [tree for tree in looks if tree in set(group.tree)]
        for tree in trees:
            values = group[group.tree == tree].set_index("codec").payload_bytes
            beside = [t for t in trees if t]
            for name, value in values.items():
                place = names.index(name) + (0 if tree == "" else .2 * (1 - 2 * beside.index(tree)) if len(beside) > 1 else 0)
                axes.barh(place, value / 1e3, height=.7 if tree == "" or len(beside) == 1 else .38, color=looks[tree])
                if name == "gotsman3-context":
                    axes.text(value / 1e3, place, f" {value / values['gotsman3'] - 1:+.0%}", va="center", fontsize=7)
        third = group[group.codec == "gotsman3"].payload_bytes.min() / 1e3
        axes.axvline(.65 * third, color=RED, linewidth=1, linestyle=":")
        axes.set(yticks=range(len(names)), xlabel="kB", xscale="log", xlim=(group.payload_bytes.min() / 2000, group.payload_bytes.max() / 800))
        plain_ticks(axes.xaxis, "", (1, 2, 5))
        axes.set_yticklabels(names, fontsize=8)
        axes.set_title(matrix, fontsize=10, loc="left")
        bare(axes)
    for axes in all_axes.flat[len(matrices):]:
        axes.set_visible(False)
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour, label={"": "no tree", "k-d": "tree: k-d over the cells' boxes", "by sets": "tree by similar sets"}[tree]) for tree, colour in looks.items()]
    figure.legend(handles=[*handles, plt.Line2D([], [], color=RED, linestyle=":", label="35 % below the plain third method")], loc="upper center", bbox_to_anchor=(.5, -.01), ncols=4, fontsize=8, frameon=False)
    return figure


def draw_search(results):
    """Anytime: bytes after so many seconds of the search for clusters, 100 % being the table without any."""
    figure, axes = plt.subplots(figsize=(9, 4.8), layout="constrained")
    matrices = list(dict.fromkeys(results.search.matrix))
    colours = plt.cm.tab10(numpy.arange(len(matrices)) % 10)
    for colour, (matrix, group) in zip(colours, results.search.groupby("matrix", sort=False)):
        seconds = group.seconds.clip(lower=.01)
        axes.step(seconds, 100 * group.bytes / group.bytes.iloc[0], where="post", color=colour, linewidth=1.3,
                  label=f"{SCENES.get(matrix, matrix)}: {group.rows.iloc[0]:,} x {group['columns'].iloc[0]:,}, {group.bytes.iloc[0] / 1e3:,.0f} kB")
        axes.plot(seconds.iloc[-1], 100 * group.bytes.iloc[-1] / group.bytes.iloc[0], marker="o", markersize=4, color=colour)
    axes.set(xscale="log", xlabel="seconds of the search", ylabel="bytes, % of the table without clusters")
    plain_ticks(axes.xaxis, " s", (1, 3))
    axes.set_ylim(0, 103)
    axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1, .5))
    bare(axes)
    axes.grid(alpha=.25)
    return figure


CHARTS = {
    "lossy_curves": ("Bytes against extra visible entries: a panel a matrix; the large mark of each line: 5 % of occlusions lost, as in Table 3", draw_curves, ("curves",)),
    "lossy_spread": ("Left: twenty seeds of the paper's grouping. Right: what 5 % lost occlusions buy where nothing is alike", draw_spread, ("seeds", "random")),
    "lossy_cells": ("Who pays: above, each cell's own loss; below, bytes under a bound on any one cell", draw_cells, ("cells", "quantiles")),
    "lossy_broken": ("Left: dense rows. Right: trees whose nodes, objects or cells are merged", draw_broken, ("dense", "trees")),
    "gotsman": ("Subsets over a tree of view cells, columns in the best order", draw_subsets, ("gotsman",)),
    "panne_search": ("Clusters: size against seconds of search", draw_search, ("search",)),
}


def charts_of(results):
    """Those whose tables are there: name to caption and function."""
    return {name: (caption, draw) for name, (caption, draw, needs) in CHARTS.items()
            if all(getattr(results, need) is not None and len(getattr(results, need)) for need in needs)}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """Merged view cells share one row, the union of theirs: nothing visible is ever hidden (each coded matrix here was read again and
compared with its original, row by row), but hidden objects are shown. <b>Lost</b> is the share of the hidden entries (occlusions) that
became visible, the paper's measure; <b>extra visible</b> the same entries as a share of the visible ones, what a renderer pays. <b>Names</b> are the bytes
that say which row and column stand for each of the source's: groups where a side is merged, else its order. Curves and shares of
lossless bytes count them; Table 3 does not, as in the paper. Matrices over nodes are coded by the paper's methods after its greedy order; others by row and
whole-file codecs after the best order of rows and columns. Published figures are in italics."""


def sections(results):
    """As report_tools.as_text wants them."""
    shown = charts_of(results)
    yield ("Table 3: paper 002's methods at 5 % lost occlusions", "In brackets: times smaller than the lossless table. 'Of published' is our ratio over theirs, "
           "Huffman codes both.", [("", table_3(results))])
    yield ("Bytes against extra visible entries", "", ["lossy_curves", ("At 5 % lost occlusions: bytes with names, and their share of what the same codec takes without loss", table_of_halves(results)),
                                                       ("At so many extra visible entries: bytes with names, of the smallest lossless ones", table_at_extra(results)),
                                                       *([("Every level that Debian packages, at 5 %: xz after the best order, both sides merged", table_of_every_level(results))]
                                                         if results.every_level is not None else [])])
    both = seeds_against_pairs(results)
    if len(both):
        yield "The paper's seeds against all pairs", "Both at the same loss; seconds of one run.", [("", both)]
    failures = []
    if "lossy_spread" in shown:
        failures += ["lossy_spread", ("Twenty seeds", table_of_seeds(results)), ("No structure, 5 % lost", table_of_random(results))]
    if "lossy_cells" in shown:
        failures += ["lossy_cells", ("A bound on single cells", table_of_cells(results))]
    if "lossy_broken" in shown:
        failures += ["lossy_broken", ("Dense rows", table_of_dense(results)), ("Trees", table_of_trees(results))]
    if failures:
        yield "Where merging fails", "", failures
    if "gotsman" in shown:
        yield ("Subsets over a tree of view cells: Gotsman, Sudarsky and Fayman 1999", "Methods and trees as docs/lossy.md says, what is known and what is ours. The last form codes the third "
               "method's trits under contexts.", ["gotsman", ("", table_of_subsets(results))])
    if "panne_search" in shown:
        yield ("Clusters: van de Panne and Stewart 1999", "The search is ours and can be stopped at any time; the lossy form is merging first, then clusters.", ["panne_search", ("", table_of_search(results))])
    yield "Every merge", "Bytes are the smallest codec's; the last column counts names.", [("", table_of_loss(results))]


def main(out="out", records=None):
    results = load(out)
    charts = {name: (caption, draw(results)) for name, (caption, draw) in charts_of(results).items()}
    tools.write_report(out, "lossy", "Clusters, subsets and controlled loss", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    main(*sys.argv[1:])
