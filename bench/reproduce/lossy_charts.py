"""The charts of merging, clusters and subsets."""
import matplotlib.pyplot as plt
import numpy
import pandas as pd

from lossy_tables import TABLE_3_LOST, TREES, lossless
from report_tools import BLUE, GREEN, GREY, LIGHT_BLUE, LIGHT_ORANGE, ORANGE, PURPLE, RED, SKY, TEAL, bare, legend_below, name_of, panels, plain_ticks

BROWN = "#795548"
# By codec; one that is not named here gets a colour of REST. Sides that are merged alone are drawn of the smallest codec only.
CODECS = {"rows-small": BLUE, "rows-quick": SKY, "rows-fast-ids": TEAL, "rows-fast-bits": GREEN, "bv": RED, "pair-ans": BROWN, "jbig1": ORANGE, "panne": PURPLE, "zach3-huffman": "#333333",
          "zach4-huffman": GREY}
REST = (GREEN, TEAL, SKY, PURPLE)
NOT_DRAWN = {"delimiter", "xz", "zach3-range", "zach4-range"}  # beside another line
ALONE = {"cells": ("--", "only view cells merged"), "objects": (":", "only objects merged")}
MARKED = {.01: ("s", "1 %"), TABLE_3_LOST: ("o", "5 %")}  # of the occlusions lost


def draw_curves(results, columns=3, matrices=None):
    """Bytes, including the maps of rows and columns, against the added entries; a panel for each matrix and a line for each codec."""
    matrices = matrices or results.matrices
    figure, all_axes = panels(len(matrices), columns, 4.9, 3.9)
    curves = results.curves[(results.curves.method == "pairs") & (results.curves.max_per_cell == 1) & ~results.curves.codec.isin(NOT_DRAWN)]
    names = list(dict.fromkeys(curves.codec))
    colours = {codec: CODECS.get(codec, REST[i % len(REST)]) for i, codec in enumerate(names)}
    alone = set()
    for axes, matrix in zip(all_axes, matrices):
        base = lossless(results, matrix)
        drawn, all_sides = curves[curves.matrix == matrix], {}
        for (side, codec), of in drawn.groupby(["side", "codec"], sort=False):
            all_sides.setdefault(side, {})[codec] = of[of.lost > 0].sort_values("added_share")
        main = "both" if "both" in all_sides else next(iter(all_sides))
        smallest = min(all_sides[main], key=lambda codec: all_sides[main][codec].total.iloc[-1])
        lines = [(codec, of, "-") for codec, of in all_sides[main].items()]
        for side, (line, _) in ALONE.items():
            if side != main and smallest in all_sides.get(side, {}):
                lines.append((smallest, all_sides[side][smallest], line))
                alone.add(side)
        for codec, of, line in lines:
            axes.plot([0, *100 * of.added_share], numpy.array([base.total[codec], *of.total]) / 1e3, color=colours[codec], linestyle=line, linewidth=1.6 if line == "-" else 1)
            for lost, (marker, _) in MARKED.items():
                at = of[of.lost == lost]
                axes.plot(100 * at.added_share, at.total / 1e3, marker=marker, markersize=4, color=colours[codec], linestyle="")
        best = base.total.reindex(all_sides[main]).min() / 1e3
        axes.axhline(best, color="black", linewidth=.7)
        axes.axhline(best / 2, color="black", linewidth=.7, linestyle=(0, (1, 4)))
        axes.set_xscale("symlog", linthresh=2, linscale=.6)
        axes.set_yscale("log")
        axes.set(xlabel="added entries, % of the visible ones", ylabel="kB with maps", xticks=[0, 1, 2, 5, 10, 20, 50, 100])
        axes.set_xlim(-.15, max(100, 110 * drawn.added_share.max()))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_locator(plt.NullLocator())
        plain_ticks(axes.yaxis, "", (1, 2, 5))
        first = base.iloc[0]
        axes.set_title(f"{name_of(matrix)}: {first.rows:,} x {first['columns']:,}, {first.ones / first.rows / first['columns']:.1%} visible", fontsize=9, loc="left")
    handles = [*(plt.Line2D([], [], color=colours[codec], linewidth=2, label=codec) for codec in names),
               *(plt.Line2D([], [], color=GREY, linestyle=line, label=f"{label}, smallest codec") for side, (line, label) in ALONE.items() if side in alone),
               *(plt.Line2D([], [], color=GREY, marker=marker, markersize=5, linestyle="", label=f"{share} of occlusions lost") for marker, share in MARKED.values()),
               plt.Line2D([], [], color="black", linewidth=.7, label="smallest without loss"), plt.Line2D([], [], color="black", linewidth=.7, linestyle=(0, (1, 4)), label="half of that")]
    legend_below(figure, handles, 6, fontsize=8)
    return figure


def draw_spread(results):
    """Twenty random seeds of the paper's grouping beside ours; and what 5 % lost occlusions save on matrices without structure."""
    figure, (spread, random) = plt.subplots(1, 2, figsize=(12, 4), layout="constrained")
    matrices = list(dict.fromkeys(results.seeds.matrix))
    for i, matrix in enumerate(matrices):
        of = results.seeds[results.seeds.matrix == matrix]
        pairs, seeds = of[of.method == "pairs"].bytes.iloc[0], of[of.method == "seeds"].bytes.sort_values().to_numpy()
        shift = i + .3 * numpy.linspace(-1, 1, len(seeds))
        spread.scatter(shift, 100 * (seeds / pairs - 1), s=16, color=BLUE, label="one random seed" if i == 0 else None)
    spread.axhline(0, color=RED, linewidth=1, label="merging by pairs")
    spread.set(xticks=range(len(matrices)), xlim=(-.6, len(matrices) - .4), ylabel="bytes, % above those of merging by pairs")
    spread.set_xticklabels([name_of(matrix).replace(".nodes", "\nover nodes") for matrix in matrices], fontsize=8)
    spread.set_title("merging by seeds (Zach and Karner 2003, section 4.1), smallest to largest", fontsize=10, loc="left")
    spread.legend(fontsize=8, frameon=False)
    noise = results.random[results.random.matrix == "random"]
    random.plot(100 * noise.density, 100 * noise.bytes / noise.bytes_before, marker="o", color=GREY, label="random matrices")
    for row in results.random[results.random.matrix != "random"].itertuples():
        share = 100 * row.bytes / row.bytes_before
        random.plot(100 * row.density, share, marker="*", markersize=11, color=BLUE, linestyle="")
        random.annotate(name_of(row.matrix), (100 * row.density, share), xytext=(-8, -3), textcoords="offset points", fontsize=8, color=BLUE, ha="right")
    random.axhline(50, color=RED, linewidth=.9, linestyle=":")
    random.set(xscale="log", xlabel="visible entries, % of all", ylabel="bytes at 5 % lost occlusions, % of lossless", ylim=(0, 100))
    plain_ticks(random.xaxis, "", (1, 2, 5))
    random.set_title("matrices without structure", fontsize=10, loc="left")
    random.legend(fontsize=8, frameon=False, loc="upper left")
    for axes in (spread, random):
        bare(axes)
        axes.grid(alpha=.25)
    return figure


def draw_cells(results):
    """The loss of each view cell from the least to the most, for several bounds on one view cell; and what the bound costs."""
    matrices = list(dict.fromkeys(results.quantiles.matrix))
    figure, all_axes = plt.subplots(2, len(matrices), figsize=(4.3 * len(matrices), 6.4), squeeze=False, layout="constrained")
    shades = plt.cm.viridis(numpy.linspace(0, .85, results.quantiles.max_per_cell.nunique()))
    for (above, below), matrix in zip(all_axes.T, matrices):
        of, costs = results.quantiles[results.quantiles.matrix == matrix], results.cells[results.cells.matrix == matrix]
        for shade, (most, group) in zip(shades, of.groupby("max_per_cell", sort=False)):
            above.plot(100 * group.share_of_cells, 100 * group.lost, color=shade, label=f"{most:.0%}")
        above.set_yscale("symlog", linthresh=20)
        above.set(xlabel="view cells, %, from the least loss to the most", ylabel="lost occlusions of the view cell, %", ylim=(0, 110), yticks=[0, 5, 10, 20, 50, 100])
        above.yaxis.set_major_formatter("{x:g}")
        above.yaxis.set_minor_locator(plt.NullLocator())
        above.set_title(name_of(matrix), fontsize=10, loc="left")
        below.bar(range(len(costs)), costs.bytes / 1e3, color=shades, width=.7)
        for i, row in enumerate(costs.itertuples()):
            below.text(i, row.bytes / 1e3, f"{row.lost_share:.1%}\nlost", ha="center", va="bottom", fontsize=7)
        below.set(xticks=range(len(costs)), xlabel="bound on the loss of one view cell (--max-per-cell)", ylabel="kB", ylim=(0, 1.22 * costs.bytes.max() / 1e3))
        below.set_xticklabels([f"{most:.0%}" for most in costs.max_per_cell])
        for axes in (above, below):
            bare(axes)
            axes.grid(alpha=.25, axis="y")
    all_axes[0, 0].legend(title="bound on the loss of one view cell", fontsize=7, title_fontsize=7, frameon=False, loc="upper left")
    return figure


def draw_broken(results):
    """Dense rows among others, and trees over merged columns."""
    figure, (dense, trees) = plt.subplots(1, 2, figsize=(12, 4.2), layout="constrained", width_ratios=(1.15, 1))
    if results.dense is not None and len(results.dense):
        of = results.dense[results.dense.method == "pairs"]
        kinds = list(dict.fromkeys(zip(of.dense, of.share)))
        bounds = list(dict.fromkeys(zip(of.lost, of.max_per_cell)))
        for i, ((lost, most), colour) in enumerate(zip(bounds, (BLUE, LIGHT_BLUE, ORANGE, LIGHT_ORANGE))):
            group = of[(of.lost == lost) & (of.max_per_cell == most)].set_index(["dense", "share"]).reindex(kinds)
            places = numpy.arange(len(kinds)) + .2 * (i - (len(bounds) - 1) / 2)
            dense.bar(places, group.bytes / 1e3, color=colour, width=.19, label=f"{lost:.0%} lost in all, at most {most:.0%} in one view cell")
            for place, row in zip(places, group.itertuples()):
                if not pd.isna(row.bytes):
                    dense.text(place, row.bytes / 1e3, f"{row.poisoned:.0f}", ha="center", va="bottom", fontsize=7)
        dense.set(xticks=range(len(kinds)), ylabel=f"kB, {of.matrix.iloc[0]}")
        dense.set_xticklabels(["no dense row" if number == 0 else f"{number} row{'s' if number > 1 else ''}\n{share:.0%} dense" for number, share in kinds], fontsize=8)
        dense.set_ylim(0, 1.35 * of.bytes.max() / 1e3)  # space for the legend
        dense.set_title("dense rows added; above each bar, how many other rows lost more than half", fontsize=9, loc="left")
        dense.legend(fontsize=7, frameon=False, loc="upper right")
    of = results.trees[results.trees.lost == results.trees.lost.max()]
    ways, matrices = list(dict.fromkeys(of.way)), list(dict.fromkeys(of.matrix))
    for i, (matrix, colour) in enumerate(zip(matrices, (BLUE, GREY, GREEN))):
        group = of[of.matrix == matrix].set_index("way").reindex(ways)
        places = numpy.arange(len(ways))[::-1] + .36 * ((len(matrices) - 1) / 2 - i)
        trees.barh(places, 100 * group.added_share, height=.34, color=colour, label=name_of(matrix))
        for place, row in zip(places, group.itertuples()):
            if not pd.isna(row.added_share):
                trees.text(100 * row.added_share + .3, place, f"{row.violations:,.0f} nodes without their parent", va="center", fontsize=7)
    trees.set(yticks=numpy.arange(len(ways))[::-1], xlabel="added entries of the nodes, % of the visible ones")
    trees.set_yticklabels([way.replace("; ", ";\n") for way in ways], fontsize=8)
    trees.set_xlim(0, 145 * of.added_share.max())
    trees.set_ylim(-1.1, len(ways) - .4)
    trees.set_title(f"a tree over the columns, {of.lost.max():.0%} lost occlusions", fontsize=9, loc="left")
    trees.legend(fontsize=8, frameon=False, loc="lower right", ncols=2)
    for axes in (dense, trees):
        bare(axes)
    return figure


def draw_subsets(results):
    """Gotsman's methods and the third one with context models, over both trees, and codecs without a tree; columns in the last order given."""
    of = results.gotsman[results.gotsman.order == results.gotsman.order.iloc[-1]]
    matrices = list(dict.fromkeys(of.matrix))
    figure, all_axes = panels(len(matrices), 3, 4.6, 3.4, grid=False)
    looks = {"": GREY, "k-d": LIGHT_BLUE, "by sets": BLUE}
    for axes, matrix in zip(all_axes, matrices):
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
        axes.set(yticks=range(len(names)), xlabel="kB", xscale="log", xlim=(group.payload_bytes.min() / 2000, group.payload_bytes.max() / 800))
        plain_ticks(axes.xaxis, "", (1, 2, 5))
        axes.set_yticklabels(names, fontsize=8)
        axes.set_title(name_of(matrix), fontsize=10, loc="left")
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour, label=f"tree {TREES[tree]}" if tree else "no tree") for tree, colour in looks.items()]
    legend_below(figure, handles, 4, fontsize=8)
    return figure


def draw_search(results):
    """Bytes against the seconds of the search for clusters; 100 % is the table without clusters."""
    figure, axes = plt.subplots(figsize=(9, 4.8), layout="constrained")
    matrices = list(dict.fromkeys(results.search.matrix))
    colours = plt.cm.tab10(numpy.arange(len(matrices)) % 10)
    for colour, (matrix, group) in zip(colours, results.search.groupby("matrix", sort=False)):
        seconds = group.seconds.clip(lower=.01)
        axes.step(seconds, 100 * group.bytes / group.bytes.iloc[0], where="post", color=colour, linewidth=1.3,
                  label=f"{name_of(matrix)}: {group.rows.iloc[0]:,} x {group['columns'].iloc[0]:,}, {group.bytes.iloc[0] / 1e3:,.0f} kB")
        axes.plot(seconds.iloc[-1], 100 * group.bytes.iloc[-1] / group.bytes.iloc[0], marker="o", markersize=4, color=colour)
    axes.set(xscale="log", xlabel="seconds of the search", ylabel="bytes, % of the table without clusters")
    plain_ticks(axes.xaxis, " s", (1, 3))
    axes.set_ylim(0, 103)
    axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1, .5))
    bare(axes)
    axes.grid(alpha=.25)
    return figure


CHARTS = {
    "lossy_curves": ("Bytes against added entries, with a panel for each matrix, view cells and objects merged where columns are objects. Squares are at 1 %, circles at 5 % lost occlusions, as in Table 3", draw_curves, ("curves",)),
    "lossy_spread": ("Left: twenty random seeds of the paper's grouping. Right: what 5 % lost occlusions save where no rows are alike", draw_spread, ("seeds", "random")),
    "lossy_cells": ("How the loss is spread over the view cells. Above: the loss of each view cell. Below: bytes under a bound on the loss of any one view cell", draw_cells, ("cells", "quantiles")),
    "lossy_broken": ("Left: dense rows among others. Right: trees whose nodes, objects or view cells are merged", draw_broken, ("dense", "trees")),
    "gotsman": ("Subsets over a tree of view cells, with the columns in the best order. Beside each bar of gotsman3-context: its bytes compared with those of gotsman3", draw_subsets, ("gotsman",)),
    "panne_search": ("Clusters: bytes against the seconds of the search", draw_search, ("search",)),
}
