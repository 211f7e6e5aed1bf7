"""The charts of orders of columns and rows."""
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy
from matplotlib.patches import Patch

from layout_tables import exponent
from report_tools import BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, TEAL, bare, legend_below, name_of, panels, plain_ticks

# Each method's colour and marker, the same in all charts.
METHODS = {"identity": ("#999999", "s"), "random": ("#cccccc", "o"), "lexicographic": ("#8d6e63", "v"), "morton": ("#c0a060", "^"),
           "bisection": (PURPLE, "<"), "neighbours": (GREEN, "D"), "greedy": ("#9ccc65", "P"), "exact-tour": (TEAL, "X"),
           "sampled-tour": (ORANGE, "o"), "flann-tour": ("#d81b60", "*"), "scale-tour": (SKY, "h"),
           "polished-tour": (BLUE, "D"), "best": ("#000000", "*")}


def look(method):
    return METHODS.get(method, (GREY, "."))


def _legend_of_methods(figure, methods, others=()):
    handles = [plt.Line2D([], [], ls="", marker=look(m)[1], color=look(m)[0], mec="#333333", mew=0.5, ms=9 if look(m)[1] == "*" else 7, label=m)
               for m in METHODS if m in methods]
    legend_below(figure, [*handles, *others], 7)


def draw_runs_against_seconds(results, side="columns"):
    """A panel for each matrix: runs as a share of those in a random order, over the seconds that the order took; the bound is a line."""
    matrices = results.matrices(side)
    figure, all_axes = panels(len(matrices), 4, 3.5, 3.1)
    for axes, matrix in zip(all_axes, matrices):
        of = results.side(matrix, side)
        random = (of.runs / (1 - of.fewer_than_random)).median()
        for method, row in of.iterrows():
            color, marker = look(method)
            axes.scatter(max(row.seconds_median, 1e-4), row.runs / random, color=color, marker=marker, s=90 if marker == "*" else 48,
                         edgecolors="#333333", linewidths=0.5, zorder=4 if method == "best" else 3)
        axes.axhline(of.bound.iloc[0] / random, color=RED, linewidth=1.2)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(5e-5, 10 ** numpy.ceil(numpy.log10(of.seconds_median.max() * 1.5)))
        axes.xaxis.set_major_locator(matplotlib.ticker.LogLocator(numticks=8))
        axes.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}"))
        axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        plain_ticks(axes.yaxis, " %")
        axes.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{100 * v:g} %"))
        axes.tick_params(labelsize=8)
        axes.set_title(f"{name_of(matrix)}: {of['columns'].iloc[0]:,} {side}", fontsize=9.5)
    figure.supxlabel("seconds to make the order (logarithmic; shorter times are drawn at 0.0001 s)", fontsize=10)
    figure.supylabel("runs, % of those in a random order (logarithmic)", fontsize=10)
    _legend_of_methods(figure, set(results.orders[results.orders.side == side].method),
                       others=[plt.Line2D([], [], color=RED, label="lower bound for every order")])
    return figure


def draw_gap_against_seconds(results, side="columns"):
    """All matrices in one chart: how far above the bound each method stays, over the seconds that it took."""
    figure, axes = plt.subplots(figsize=(9, 5), layout="constrained")
    bare(axes)
    axes.grid(which="major", color="#e6e6e6")
    table = results.orders[(results.orders.side == side) & (results.orders.gap > 0)]
    for method, group in table.groupby("method", sort=False):
        color, marker = look(method)
        axes.scatter(group.seconds_median.clip(lower=1e-4), 100 * group.gap, color=color, marker=marker, s=70 if marker == "*" else 36,
                     edgecolors="#333333", linewidths=0.4, alpha=0.85)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    plain_ticks(axes.yaxis, " %", (1,))
    axes.set_xlabel("seconds to make the order (logarithmic; shorter times are drawn at 0.0001 s)")
    axes.set_ylabel("runs above the lower bound, % (logarithmic)")
    _legend_of_methods(figure, set(table.method))
    return figure


def draw_convergence(results, matrices=None):
    """The bound's ascent: how far the fewest runs found lie above it after each step."""
    table = results.bounds[results.bounds.side == "columns"]
    if matrices is None:
        matrices = [m for m in ("artificial-2", "oasago2.faces") if m in set(table.matrix)] or list(dict.fromkeys(table.matrix))[:2]
    figure, all_axes = panels(len(matrices), len(matrices), 5, 3.4)
    for axes, matrix in zip(all_axes, matrices):
        of = table[table.matrix == matrix]
        axes.plot(of.step, 100 * (of.least_runs / of.bound.clip(lower=1) - 1), color=BLUE)
        axes.set_yscale("log")
        plain_ticks(axes.yaxis, " %")
        axes.set_xlabel("round of the ascent of the bound")
        axes.set_ylabel("best order found, % above the bound")
        axes.set_title(f"{name_of(matrix)}: ends {100 * (of.least_runs.iloc[-1] / of.bound.iloc[-1] - 1):.2f} % above, {of.seconds.iloc[-1]:.1f} s", fontsize=10)
    return figure


def draw_distances(results):
    """Fig. 6 of the paper for our data."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.8), layout="constrained")
    colors = plt.get_cmap("tab10").colors
    for i, (matrix, group) in enumerate(results.density.groupby("matrix", sort=False)):
        left.plot(group.points, 100 * group.within_twice, marker="o", ms=3.5, color=colors[i % 10], label=name_of(matrix))
        of = results.radius[results.radius.matrix == matrix]
        right.plot(of.multiple, 100 * of.within, color=colors[i % 10])
    left.axhline(25, color="black", linestyle="--", linewidth=1)
    left.text(0.99, 26.5, "Chhugani et al. 2005: alpha is about 25 %", ha="right", transform=left.get_yaxis_transform(), fontsize=9)
    for axes in (left, right):
        bare(axes)
        axes.set_xscale("log")
        axes.grid(which="major", color="#e6e6e6")
    left.set_yscale("log")
    left.set_ylim(top=100)
    plain_ticks(left.yaxis, " %", (1,))
    left.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:,.0f}"))
    left.set_xlabel("points in the set")
    left.set_ylabel("other points within twice the distance\nof the nearest neighbour, %")
    right.axvline(2, color="black", linestyle="--", linewidth=1)
    plain_ticks(right.xaxis, "")
    right.set_xlabel("radius, in multiples of the distance of the nearest neighbour")
    right.set_ylabel("other points within the radius, %")
    figure.legend(loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=5, frameon=False)
    return figure


def draw_scale(results):
    """Runs, seconds and memory against the number of ones, for each method and scene; published figures are hollow."""
    figure, all_axes = panels(3, 3, 4.4, 3.9)
    styles = {"power-plant": "-", "city": "--"}
    for (scene, harder, method), group in results.scale.groupby(["scene", "harder", "method"], sort=False):
        group = group.sort_values("ones")
        if method == "random":
            continue
        color, marker = look(method)
        style = dict(color=color, marker=marker, ms=5, linestyle=styles.get(scene, "-"), alpha=0.45 if harder else 1, mfc="white" if harder else color)
        all_axes[0].plot(group.ones, 100 * group.runs_per_random, **style)
        same_bound = group[(group.held_karp > 0) == (group.held_karp.iloc[-1] > 0)]
        for axes, column, unit in ((all_axes[1], "order_cpu_seconds", 1), (all_axes[2], "peak_bytes", 1e-9)):
            of = same_bound if column == "peak_bytes" else group
            axes.plot(of.ones, of[column] * unit, **style)
            slope = exponent(group, column)
            if not harder and not numpy.isnan(slope):
                axes.text(0.02, 0.98 - 0.065 * len(axes.texts), f"{method}, {name_of(scene)}: entries^{slope:.2f}", transform=axes.transAxes,
                          fontsize=8.5, color=color, va="top")
    for scene, paper in results.paper.iterrows():
        ones = paper.ones_per_column * paper["columns"]
        all_axes[0].scatter(ones, 100 * (1 - paper.fewer_runs), marker="o" if scene == "power-plant" else "s", facecolors="none",
                          edgecolors="black", s=60, zorder=4)
        all_axes[1].scatter(ones, paper.seconds_lists + paper.seconds_tour, marker="o" if scene == "power-plant" else "s", facecolors="none",
                          edgecolors="black", s=60, zorder=4)
    for axes, label in zip(all_axes, ("runs, % of those in a random order", "processor seconds to make the order", "peak memory to make the order, GB")):
        axes.set_xscale("log")
        axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        axes.set_xlabel("visible entries of the matrix")
        axes.set_ylabel(label)
        axes.margins(x=0.12)
    all_axes[0].set_ylim(bottom=0)
    for axes in all_axes[1:]:
        axes.set_yscale("log")
        axes.set_ylim(top=axes.get_ylim()[1] * 8)  # room for the exponents
        axes.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}"))
        axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    present = [m for m in dict.fromkeys(results.scale.method) if m != "random"]
    handles = [plt.Line2D([], [], color=look(m)[0], marker=look(m)[1], label=m) for m in present]
    handles += [plt.Line2D([], [], color=GREY, linestyle=styles[s], label=name_of(s)) for s in styles if s in set(results.scale.scene)]
    if results.scale.harder.any():
        handles.append(plt.Line2D([], [], color=GREY, marker="o", mfc="white", alpha=0.6, label="harder variant"))
    handles += [plt.Line2D([], [], color="black", ls="", marker=m, mfc="none", label=f"published, {n}") for m, n in (("o", "power plant"), ("s", "city"))]
    legend_below(figure, handles, 4)
    return figure


def draw_walk(results):
    """How many fewer disk reads (bars) and bytes read (dots) each order has than a random order."""
    walk = results.walk
    levels = list(dict.fromkeys(walk.matrix))
    figure, all_axes = panels(len(levels), 2, 6.4, 3.2, sharey=True)
    orders = [order for order in dict.fromkeys(walk.layout) if order != "random"]
    colors = {order: look("identity" if order == "natural" else order)[0] for order in orders}
    for axes, level in zip(all_axes, levels):
        groups = list(walk[walk.matrix == level].groupby(["page_bytes", "read_ahead_pages"], sort=True))
        for i, (_, group) in enumerate(groups):
            of = group.set_index("layout")
            for j, order in enumerate(orders):
                x = i + 0.8 * ((j + 0.5) / len(orders) - 0.5)
                fewer, less = (100 * (1 - of.loc[order, column] / of.loc["random", column]) for column in ("reads", "bytes_read"))
                axes.bar(x, fewer, 0.8 / len(orders), color=colors[order])
                axes.scatter(x, less, s=22, marker="o", facecolors="white", edgecolors=RED, zorder=3)
        axes.set_xticks(range(len(groups)), [f"{page / 1024:g} KB\n{ahead}" for (page, ahead), _ in groups], fontsize=8)
        axes.axhline(0, color="black", linewidth=0.8)
        axes.axhline(60, color="black", linestyle="--", linewidth=1)
        axes.grid(axis="x", visible=False)
        axes.set_title(level, fontsize=10)
    figure.supylabel("fewer than in a random order, %", fontsize=10)
    figure.supxlabel("page size, and below it the pages of read-ahead", fontsize=10)
    handles = [Patch(color=colors[n], label=f"reads, {n}") for n in orders]
    handles.append(plt.Line2D([], [], ls="", marker="o", mfc="white", mec=RED, label="bytes read"))
    handles.append(plt.Line2D([], [], color="black", linestyle="--", label="Chhugani et al. 2005: almost 60 % fewer reads"))
    legend_below(figure, handles, 5)
    return figure


STUDIES = {"random": "ones, share of all entries", "near-duplicates": "bits flipped in each of ten copies",
           "random rows first": "random rows before the others", "dominant row": "copies of one random row",
           "planted blocks": "bits flipped, share of all entries", "zero and full columns": "share of zero and full columns"}


def draw_shapes(results):
    """A panel for each study: runs in multiples of the bound, over the parameter of the study."""
    shuffled = results.shapes.method.isin(["identity", "random"])  # the columns come shuffled
    table = results.shapes[results.shapes.study.isin(list(STUDIES)) & ~shuffled]
    table = table.assign(excess=table.runs / table.bound.clip(lower=1))
    studies = [s for s in STUDIES if s in set(table.study)]
    figure, all_axes = panels(len(studies), 3, 4.2, 3.2)
    for axes, study in zip(all_axes, studies):
        of = table[table.study == study]
        places = sorted(of.parameter.unique())
        for method, group in of.groupby("method", sort=False):
            color, marker = look(method)
            axes.plot([places.index(p) for p in group.parameter], group.excess, color=color, marker=marker, ms=7 if marker == "*" else 4.5, linewidth=1)
        first = of.drop_duplicates("parameter")
        axes.plot([places.index(p) for p in first.parameter], first.random / first.bound, color="black", linestyle=":", linewidth=1)
        axes.set_xticks(range(len(places)), [f"{p:g}" for p in places])
        axes.set_yscale("log")
        plain_ticks(axes.yaxis, "x", (1, 2, 5))
        axes.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
        if axes.get_ylim()[1] < 2.2:
            axes.yaxis.set_major_locator(matplotlib.ticker.MultipleLocator(0.2))
        axes.set_xlabel(STUDIES[study], fontsize=9)
        axes.set_title(study, fontsize=10)
    figure.supylabel("runs, in multiples of the lower bound (logarithmic)", fontsize=10)
    _legend_of_methods(figure, set(table.method), others=[plt.Line2D([], [], color="black", linestyle=":", label="mean of random orders")])
    return figure


def draw_samples(results):
    """Sampled tours: runs in multiples of those by exact-tour, over the size of the sample; a line for each k, with and without flips."""
    matrices = list(dict.fromkeys(results.samples.matrix))
    figure, all_axes = panels(len(matrices), 3, 4.6, 3.6)
    for axes, matrix in zip(all_axes, matrices):
        of = results.samples[results.samples.matrix == matrix]
        for part, color in zip((16, 4, 1), (ORANGE, SKY, PURPLE)):
            for flips, line in ((0, ":"), (1, "-")):
                group = of[(of.k_one_in == part) & (of.flips == flips)]
                axes.plot(1 / group.one_in, group.runs / group.exact_tour, color=color, linestyle=line, marker="o", ms=4)
        axes.axhline(1, color="black", linewidth=0.8)
        axes.axhline(of.bound.iloc[0] / of.exact_tour.iloc[0], color=RED, linewidth=1.2)
        axes.set_xscale("log")
        axes.set_yscale("log")
        plain_ticks(axes.yaxis, "x")
        axes.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
        shares = sorted(of.one_in.unique())
        axes.set_xticks([1 / n for n in shares], [f"1/{n}" if n > 1 else "all" for n in shares])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("columns that are sampled for each column")
        axes.set_ylabel("runs, in multiples of those by exact-tour")
        axes.set_title(f"{name_of(matrix)}: {of['columns'].iloc[0]:,} columns", fontsize=10)
    handles = [plt.Line2D([], [], color=c, marker="o", ms=4, label=f"k = {n}") for n, c in (("sample / 16", ORANGE), ("sample / 4", SKY), ("sample", PURPLE))]
    handles += [plt.Line2D([], [], color=GREY, linestyle=":", label="without the edge flips of step 4"), plt.Line2D([], [], color=GREY, label="with edge flips"),
                plt.Line2D([], [], color=RED, label="lower bound")]
    legend_below(figure, handles, 6)
    return figure


def draw_flann(results):
    """FLANN's indexes beside a scan of all columns: recall and time of a query, over the dimension; a column of panels for each density."""
    densities = sorted(results.flann.density.unique())
    figure, all_axes = plt.subplots(2, len(densities), figsize=(3.5 * len(densities), 5.6), squeeze=False, sharex=True, sharey="row", layout="constrained")
    indexes = list(dict.fromkeys(results.flann["index"]))
    styles = dict(zip(indexes, ((GREY, "s"), (BLUE, "o"), (ORANGE, "^"), (PURPLE, "D"), (TEAL, "v"))))
    for column, density in enumerate(densities):
        for index, group in results.flann[results.flann.density == density].groupby("index", sort=False):
            group, (color, marker) = group.sort_values("rows"), styles[index]
            all_axes[0][column].plot(group.rows, 100 * group.recall, color=color, marker=marker, ms=5, linewidth=1)
            all_axes[1][column].plot(group.rows, group.us_per_query, color=color, marker=marker, ms=5, linewidth=1)
        all_axes[0][column].set_title(f"{density:.1%} ones", fontsize=10)
        all_axes[1][column].set_yscale("log")
        all_axes[1][column].set_xscale("log", base=2)
        all_axes[1][column].set_xticks(sorted(results.flann.rows.unique()), [f"{r:,}" for r in sorted(results.flann.rows.unique())])
    for axes in all_axes.flat:
        bare(axes)
        axes.grid(which="major", color="#e6e6e6")
    all_axes[0][0].set_ylabel("recall of the nearest, %")
    all_axes[1][0].set_ylabel("microseconds for each query")
    figure.supxlabel("rows: the dimension of a column", fontsize=10)
    handles = [plt.Line2D([], [], color=styles[i][0], marker=styles[i][1], label=i) for i in indexes]
    legend_below(figure, handles, 5)
    return figure


CHARTS = {
    "runs_against_seconds": ("Runs against seconds, with a panel for each matrix. The star is best; no order can lie below the red line", draw_runs_against_seconds, []),
    "gap_against_seconds": ("The same near the bound, with a mark for each matrix and method", draw_gap_against_seconds, []),
    "bound_convergence": ("Convergence of the lower bound", draw_convergence, []),
    "distances": ("Fig. 6 of Chhugani et al. 2005 for our data: points near a random point, by the number of points and by the radius", draw_distances, []),
    "scale": ("Runs, seconds and memory against size, up to the size in the paper", draw_scale, []),
    "walk": ("Disk reads and bytes read on walks through levels, compared with a random order of the faces on the disk (Fig. 12 of Chhugani et al. 2005)", draw_walk, ["walk"]),
    "failures_shapes": ("Synthetic matrices on which orders fail", draw_shapes, []),
    "failures_samples": ("The published method by sample size and k", draw_samples, []),
    "failures_flann": ("FLANN's indexes and a plain scan: recall and time by dimension and density", draw_flann, []),
}
