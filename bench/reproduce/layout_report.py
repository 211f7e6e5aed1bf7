"""Orders of columns and rows: what ours reach beside what is proven, published and measured before: text, charts, one page.

    bench/layout_report.py [OUT [RECORDS]]    reads the tables that ./reproduce layout had written to OUT/layout; writes
                                              OUT/layout.html, OUT/layout/layout.txt and OUT/layout/*.png; prints the text;
                                              keeps text and tables, machine and commit in their first lines, in RECORDS

The notebook imports the same functions. Nothing here measures: every figure is read or a quotient of two that are.
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
# Each method's colour and marker, the same in all charts.
METHODS = {"identity": ("#999999", "s"), "random": ("#cccccc", "o"), "lexicographic": ("#8d6e63", "v"), "morton": ("#c0a060", "^"),
           "bisection": ("#7e57c2", "<"), "neighbours": ("#558b2f", "D"), "greedy": ("#9ccc65", "P"), "exact-tour": ("#26a69a", "X"),
           "sampled-tour": ("#ef6c00", "o"), "flann-tour": ("#d81b60", "*"), "scale-tour": ("#42a5f5", "h"),
           "polished-tour": ("#1f4e79", "D"), "best": ("#000000", "*")}
SCENES = {"power-plant": "power plant", "city": "city"}


def look(method):
    return METHODS.get(method, (GREY, "."))


@dataclass
class Results:
    """A table of each program of bench/, as it wrote them, and the published figures."""
    orders: pd.DataFrame
    bounds: pd.DataFrame
    density: pd.DataFrame
    radius: pd.DataFrame
    scale: pd.DataFrame
    walk: pd.DataFrame | None
    flann: pd.DataFrame
    shapes: pd.DataFrame
    samples: pd.DataFrame
    seeds: pd.DataFrame
    recall: pd.DataFrame
    reference: pd.DataFrame
    paper: pd.DataFrame

    def matrices(self, side="columns"):
        return list(dict.fromkeys(self.orders[self.orders.side == side].matrix))

    def side(self, matrix, side="columns"):
        """A matrix's methods, in the table's order."""
        return self.orders[(self.orders.matrix == matrix) & (self.orders.side == side)].set_index("method")


def load(out):
    folder = pathlib.Path(out) / "layout"

    def read(path):
        return pd.read_csv(path, comment="#")

    scale = pd.concat([read(path) for path in folder.glob("scale_*.csv")], ignore_index=True)
    scale = scale.sort_values(["scene", "harder", "scale"], ascending=[False, True, True], kind="stable")
    walk = folder / "disk_walk.csv"  # not there where no level is
    walk = read(walk).replace({"layout": {"identity": "natural"}}) if walk.exists() else None
    return Results(*(read(folder / f"{name}.csv") for name in ("orders", "orders_bounds", "distance_density", "distance_radius")), scale, walk,
                   *(read(folder / f"{name}.csv") for name in ("flann_recall", "failures_shapes", "failures_samples", "failures_seeds",
                                                                "failures_recall")),
                   read(PUBLISHED / "orders_reference.csv").set_index("matrix"), read(PUBLISHED / "orders_paper.csv").set_index("scene"))


def name_of(matrix):
    return matrix.replace("artificial-", "artificial ")


# ---- tables ----------------------------------------------------------------------------------------------------------------

MEASURES = {"runs": ("runs", "{:,.0f}"), "fewer than random, %": ("fewer_than_random", "{:.1f}"), "above the bound, %": ("gap", "{:.2f}"),
            "seconds": ("seconds_median", "{:.3f}"), "peak memory, MB": ("peak_bytes", "{:.0f}")}
SCALING = {"fewer_than_random": 100, "gap": 100, "peak_bytes": 1e-6}


def table_of_orders(results, side="columns"):
    """Methods by matrices, a block a measure; * marks the fewest runs."""
    matrices = results.matrices(side)
    methods = list(dict.fromkeys(results.orders[results.orders.side == side].method))
    rows = []
    for label, (column, form) in MEASURES.items():
        for method in methods:
            row = {"": method, "measure": label}
            for matrix in matrices:
                of = results.side(matrix, side)
                if method not in of.index:
                    row[name_of(matrix).replace(".", "\n")] = "-"
                    continue
                value = form.format(of.loc[method, column] * SCALING.get(column, 1))
                star = "*" if column == "runs" and of.loc[method, "runs"] == of.runs.min() else ""
                row[name_of(matrix).replace(".", "\n")] = value + star
            rows.append(row)
        if column == "gap":
            row = {"": "bound, runs", "measure": label}
            row |= {name_of(matrix).replace(".", "\n"): f"{results.side(matrix, side).bound.iloc[0]:,.0f}" for matrix in matrices}
            rows.append(row)
    return pd.DataFrame(rows)


def blocks_of_orders(results, side="columns"):
    """The same, a table a measure."""
    table = table_of_orders(results, side)
    return {label: table[table.measure == label].drop(columns="measure") for label in MEASURES}


def table_of_references(results):
    """Ours beside the prototype's, shares of the runs of a random order beside."""
    rows = []
    for matrix, theirs in results.reference.iterrows():
        if matrix not in results.matrices():
            continue
        of = results.side(matrix)
        ours = pd.Series({"random": of.runs["random"], "natural": of.runs["identity"], "sampled_256": of.runs["sampled-tour"],
                          "exact": of.runs["exact-tour"], "polished": of.runs["best"], "bound": of.bound.iloc[0]})
        for whose, figures in (("ours", ours), (theirs.source, theirs)):
            def cell(key):
                return f"{figures[key]:,.0f} ({figures[key] / figures['random']:.1%})"
            rows.append({"matrix": name_of(matrix), "": whose, "random": f"{figures['random']:,.0f}", "natural": cell("natural"),
                         "sampled-tour": cell("sampled_256"), "exact-tour": cell("exact"), "best": cell("polished"), "bound": cell("bound"),
                         "best above\nthe bound": f"{figures['polished'] / figures['bound'] - 1:.2%}"})
    return pd.DataFrame(rows)


def _scene(row):
    return SCENES.get(row.scene, row.scene) + (", harder" if row.harder else "")


def _share(scale):
    return "1" if scale == 1 else f"1/{1 / scale:.0f}"


def table_of_paper(results):
    """Fewer runs than a random order: the published method and ours, by scene and size; the paper's figures below."""
    rows = []
    for (scene, harder, scale), group in results.scale.groupby(["scene", "harder", "scale"], sort=False):
        of = group.set_index("method")
        rows.append({"scene": _scene(group.iloc[0]), "": "ours", "size": _share(scale), "columns": f"{of['columns'].iloc[0]:,}",
                     **{method: f"{1 - of.runs_per_random[method]:.1%} ({of.order_seconds[method]:.1f} s)"
                        for method in of.index if method != "random"}})
    for scene, paper in results.paper.iterrows():
        rows.append({"scene": SCENES[scene], "": "published", "size": "1", "columns": f"{paper['columns']:,.0f}",
                     "sampled-tour": f"{paper.fewer_runs:.1%} ({paper.seconds_lists + paper.seconds_tour:,.0f} s)"})
    return pd.DataFrame(rows).fillna("-")


def exponent(group, column):
    """Growth of a cost with the ones: the slope of its logarithms. Memory is a bound's too, so only that of the last size's kind counts."""
    if column == "peak_bytes":
        group = group[(group.held_karp > 0) == (group.held_karp.iloc[-1] > 0)]
    return numpy.polyfit(numpy.log(group.ones), numpy.log(group[column]), 1)[0] if len(group) > 1 else float("nan")


def table_of_scale(results):
    rows = []
    for (_, _, method), group in results.scale.groupby(["scene", "harder", "method"], sort=False):
        group = group.sort_values("ones")

        def growth(column):
            slope = exponent(group, column)
            return "" if numpy.isnan(slope) else f"{slope:.2f}"

        for i, row in enumerate(group.itertuples()):
            last = i == len(group) - 1
            bound = max(row.two_nearest, row.held_karp)
            rows.append({"scene": _scene(row), "method": method, "size": _share(row.scale), "columns": f"{row.columns:,}", "ones": f"{row.ones:,}",
                         "runs": f"{row.runs:,}", "of random": f"{row.runs_per_random:.3f}",
                         "above the\nbound": f"{row.runs / bound - 1:.1%}" if bound > 0 else "-",
                         "bound": "-" if bound == 0 else "Held-Karp" if bound == row.held_karp else "two-nearest",
                         "seconds": f"{row.order_seconds:.2f}", "processor\nseconds": "-" if numpy.isnan(row.order_cpu_seconds) else f"{row.order_cpu_seconds:.2f}",
                         "peak GB": f"{row.peak_bytes / 1e9:.2f}",
                         "seconds ~\nones^": growth("order_cpu_seconds") if last and row.method != "random" else "",
                         "memory ~\nones^": growth("peak_bytes") if last else ""})
    return pd.DataFrame(rows)


def table_of_alpha(results):
    """Share of points within twice the nearest one's distance: the paper's alpha."""
    rows = [{"points": "published, both scenes", "columns": "400,000 and 790,000", "distinct": "-", "have an\nequal column": "-",
             "alpha": f"{results.paper.alpha.iloc[0]:.2f}", "median\npoint": "-", "paper's sample rule\nwould need": "1 x"}]
    for matrix, group in results.density.groupby("matrix", sort=False):
        last = group.iloc[-1]
        rows.append({"points": name_of(matrix), "columns": f"{last['columns']:,}", "distinct": f"{last.distinct:,}",
                     "have an\nequal column": f"{last.with_an_equal:.1%}", "alpha": f"{last.within_twice:.4f}", "median\npoint": f"{last.within_twice_median:.4f}",
                     "paper's sample rule\nwould need": f"{results.paper.alpha.iloc[0] / last.within_twice:,.0f} x"})
    return pd.DataFrame(rows)


def table_of_walk(results):
    """Disk reads of a walk through a level, a column a layout; in brackets, fewer than in random order."""
    rows = []
    for (matrix, page, ahead), group in results.walk.groupby(["matrix", "page_bytes", "read_ahead_pages"], sort=False):
        of = group.set_index("layout")
        rows.append({"level": matrix, "page": f"{page / 1024:g} KB", "read\nahead": f"{ahead}", "cells\nentered": f"{of.steps.iloc[0]:,}",
                     "MB\nwanted": f"{of.bytes_wanted.iloc[0] / 1e6:.1f}", "MB read,\nrandom": f"{of.bytes_read['random'] / 1e6:.1f}",
                     "MB read,\nbest": f"{of.bytes_read['best'] / 1e6:.1f}",
                     **{f"reads,\n{layout}": f"{reads:,} ({1 - reads / of.reads['random']:.1%})" if layout != "random" else f"{reads:,}"
                        for layout, reads in of.reads.items()}})
    return pd.DataFrame(rows)


def table_of_seeds(results):
    t = results.seeds
    return pd.DataFrame({"matrix": t.matrix.map(name_of), "method": t.method, "seeds": t.seeds, "mean runs": t["mean"].map("{:,.0f}".format),
                         "deviation / mean": (t.deviation / t["mean"]).map("{:.3%}".format),
                         "(most - least) / mean": ((t.most - t.least) / t["mean"]).map("{:.3%}".format)})


def table_of_recall(results):
    t = results.recall
    return pd.DataFrame({"matrix": t.matrix.map(name_of), "points": t.points.map("{:,}".format), "mean ones": t.mean_weight.map("{:,}".format),
                         "sketch bits": t.sketch_bits, "recall of\nthe 10 nearest": t.recall.map("{:.1%}".format),
                         "nearest\nfound": t.nearest_found.map("{:.1%}".format), "processor\nseconds": t.cpu_seconds.map("{:.2f}".format),
                         "brute force": t.brute_cpu_seconds.map("{:.1f}".format)})


# ---- charts ----------------------------------------------------------------------------------------------------------------

def _panels(count, columns, width, height, **more):
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width * columns, height * rows), squeeze=False, layout="constrained", **more)
    axes = list(axes.flat)
    for spare in axes[count:]:
        spare.set_axis_off()
    for a in axes[:count]:
        bare(a)
        a.grid(which="major", color="#e6e6e6")
    return figure, axes[:count]


def _legend_of_methods(figure, methods, **more):
    handles = [plt.Line2D([], [], ls="", marker=look(m)[1], color=look(m)[0], mec="#333333", mew=0.5, ms=9 if look(m)[1] == "*" else 7, label=m)
               for m in METHODS if m in methods]
    handles += more.pop("others", [])
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=min(7, len(handles)), frameon=False, **more)


def draw_runs_against_seconds(results, side="columns"):
    """A panel a matrix: runs as a share of a random order's, over the seconds the order took; the bound as a line."""
    matrices = results.matrices(side)
    figure, panels = _panels(len(matrices), min(4, len(matrices)), 3.5, 3.1)
    for axes, matrix in zip(panels, matrices):
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
    figure.supxlabel("seconds (log; faster than 0.0001 s stands there)", fontsize=10)
    figure.supylabel("runs, of a random order's (log)", fontsize=10)
    _legend_of_methods(figure, set(results.orders[results.orders.side == side].method),
                       others=[plt.Line2D([], [], color=RED, label="no order is below")])
    return figure


def draw_gap_against_seconds(results, side="columns"):
    """All matrices in one: how far above the bound, over seconds, each method its own colour; what a second more buys near the bound."""
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
    axes.set_xlabel("seconds (log; faster than 0.0001 s stands there)")
    axes.set_ylabel("runs above the lower bound (log)")
    _legend_of_methods(figure, set(table.method))
    return figure


def draw_convergence(results, matrices=None):
    """The bound's ascent: how far the fewest runs found lie above it after each step."""
    table = results.bounds[results.bounds.side == "columns"]
    if matrices is None:
        matrices = [m for m in ("artificial-2", "oasago2.faces") if m in set(table.matrix)] or list(dict.fromkeys(table.matrix))[:2]
    figure, panels = _panels(len(matrices), len(matrices), 5, 3.4)
    for axes, matrix in zip(panels, matrices):
        of = table[table.matrix == matrix]
        axes.plot(of.step, 100 * (of.least_runs / of.bound.clip(lower=1) - 1), color=BLUE)
        axes.set_yscale("log")
        plain_ticks(axes.yaxis, " %")
        axes.set_xlabel("round of the ascent")
        axes.set_ylabel("best order above the bound")
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
    left.text(0.99, 26.5, "paper: alpha about 25 %", ha="right", transform=left.get_yaxis_transform(), fontsize=9)
    for axes in (left, right):
        bare(axes)
        axes.set_xscale("log")
        axes.grid(which="major", color="#e6e6e6")
    left.set_yscale("log")
    left.set_ylim(top=100)
    plain_ticks(left.yaxis, " %", (1,))
    left.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:,.0f}"))
    left.set_xlabel("points in the set")
    left.set_ylabel("other points within twice the nearest one's distance")
    right.axvline(2, color="black", linestyle="--", linewidth=1)
    plain_ticks(right.xaxis, "")
    right.set_xlabel("radius, as a multiple of the nearest one's distance")
    right.set_ylabel("other points within it, %")
    figure.legend(loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=5, frameon=False)
    return figure


def draw_scale(results):
    """Runs, seconds and memory against the ones, each method of each scene; published figures hollow."""
    figure, panels = _panels(3, 3, 4.4, 3.9)
    styles = {"power-plant": "-", "city": "--"}
    for (scene, harder, method), group in results.scale.groupby(["scene", "harder", "method"], sort=False):
        group = group.sort_values("ones")
        if method == "random":
            continue
        color, marker = look(method)
        style = dict(color=color, marker=marker, ms=5, linestyle=styles.get(scene, "-"), alpha=0.45 if harder else 1, mfc="white" if harder else color)
        panels[0].plot(group.ones, 100 * group.runs_per_random, **style)
        same_bound = group[(group.held_karp > 0) == (group.held_karp.iloc[-1] > 0)]
        for axes, column, unit in ((panels[1], "order_cpu_seconds", 1), (panels[2], "peak_bytes", 1e-9)):
            of = same_bound if column == "peak_bytes" else group
            axes.plot(of.ones, of[column] * unit, **style)
            slope = exponent(group, column)
            if not harder and not numpy.isnan(slope):
                axes.text(0.02, 0.98 - 0.065 * len(axes.texts), f"{method}, {SCENES[scene]}: ones^{slope:.2f}", transform=axes.transAxes,
                          fontsize=8.5, color=color, va="top")
    for scene, paper in results.paper.iterrows():
        ones = paper.ones_per_column * paper["columns"]
        panels[0].scatter(ones, 100 * (1 - paper.fewer_runs), marker="o" if scene == "power-plant" else "s", facecolors="none",
                          edgecolors="black", s=60, zorder=4)
        panels[1].scatter(ones, paper.seconds_lists + paper.seconds_tour, marker="o" if scene == "power-plant" else "s", facecolors="none",
                          edgecolors="black", s=60, zorder=4)
    for axes, label in zip(panels, ("runs, % of a random order's", "processor seconds of the order", "peak memory of the order, GB")):
        axes.set_xscale("log")
        axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        axes.set_xlabel("ones of the matrix")
        axes.set_ylabel(label)
        axes.margins(x=0.12)
    panels[0].set_ylim(bottom=0)
    for axes in panels[1:]:
        axes.set_yscale("log")
        axes.set_ylim(top=axes.get_ylim()[1] * 8)  # room for the exponents
        axes.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}"))
        axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    present = [m for m in dict.fromkeys(results.scale.method) if m != "random"]
    handles = [plt.Line2D([], [], color=look(m)[0], marker=look(m)[1], label=m) for m in present]
    handles += [plt.Line2D([], [], color=GREY, linestyle=styles[s], label=SCENES[s]) for s in styles if s in set(results.scale.scene)]
    if results.scale.harder.any():
        handles.append(plt.Line2D([], [], color=GREY, marker="o", mfc="white", alpha=0.6, label="harder variant"))
    handles += [plt.Line2D([], [], color="black", ls="", marker=m, mfc="none", label=f"published, {n}") for m, n in (("o", "power plant"), ("s", "city"))]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=4, frameon=False)
    return figure


def draw_walk(results):
    """Disk reads (bars) and bytes read (dots) of each layout, as a share fewer than in random order."""
    walk = results.walk
    levels = list(dict.fromkeys(walk.matrix))
    figure, panels = _panels(len(levels), 2, 6.4, 3.2, sharey=True)
    layouts = [layout for layout in dict.fromkeys(walk.layout) if layout != "random"]
    colors = {layout: look("identity" if layout == "natural" else layout)[0] for layout in layouts}
    for axes, level in zip(panels, levels):
        groups = list(walk[walk.matrix == level].groupby(["page_bytes", "read_ahead_pages"], sort=True))
        for i, (_, group) in enumerate(groups):
            of = group.set_index("layout")
            for j, layout in enumerate(layouts):
                x = i + 0.8 * ((j + 0.5) / len(layouts) - 0.5)
                fewer, less = (100 * (1 - of.loc[layout, column] / of.loc["random", column]) for column in ("reads", "bytes_read"))
                axes.bar(x, fewer, 0.8 / len(layouts), color=colors[layout])
                axes.scatter(x, less, s=22, marker="o", facecolors="white", edgecolors=RED, zorder=3)
        axes.set_xticks(range(len(groups)), [f"{page / 1024:g} KB\n{ahead}" for (page, ahead), _ in groups], fontsize=8)
        axes.axhline(0, color="black", linewidth=0.8)
        axes.axhline(60, color="black", linestyle="--", linewidth=1)
        axes.grid(axis="x", visible=False)
        axes.set_title(level, fontsize=10)
    figure.supylabel("fewer than in random order, %", fontsize=10)
    figure.supxlabel("page size, pages of read-ahead", fontsize=10)
    handles = [matplotlib.patches.Patch(color=colors[n], label=f"reads, {n}") for n in layouts]
    handles.append(plt.Line2D([], [], ls="", marker="o", mfc="white", mec=RED, label="bytes read"))
    handles.append(plt.Line2D([], [], color="black", linestyle="--", label="paper 000: almost 60 % fewer reads"))
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=5, frameon=False)
    return figure


STUDIES = {"random": "ones, share of all entries", "near-duplicates": "bits flipped in each of ten copies",
           "random rows first": "random rows before the others", "dominant row": "copies of one random row",
           "planted blocks": "bits flipped, share of all entries", "zero and full columns": "share of zero and full columns"}


def draw_shapes(results):
    """Each study's parameter across, excess over the bound up."""
    shuffled = results.shapes.method.isin(["identity", "random"])  # the columns come shuffled
    table = results.shapes[results.shapes.study.isin(list(STUDIES)) & ~shuffled]
    table = table.assign(excess=table.runs / table.bound.clip(lower=1))
    studies = [s for s in STUDIES if s in set(table.study)]
    figure, panels = _panels(len(studies), 3, 4.2, 3.2)
    for axes, study in zip(panels, studies):
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
    figure.supylabel("runs, multiples of the lower bound (log)", fontsize=10)
    _legend_of_methods(figure, set(table.method), others=[plt.Line2D([], [], color="black", linestyle=":", label="mean of random orders")])
    return figure


def draw_samples(results):
    """Sampled tours: runs per exact-tour's against the sample, a line a share k of it; flips off and on."""
    matrices = list(dict.fromkeys(results.samples.matrix))
    figure, panels = _panels(len(matrices), min(3, len(matrices)), 4.6, 3.6)
    for axes, matrix in zip(panels, matrices):
        of = results.samples[results.samples.matrix == matrix]
        for part, color in zip((16, 4, 1), ("#ef6c00", "#42a5f5", "#7e57c2")):
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
        axes.set_xlabel("columns sampled for each")
        axes.set_ylabel("runs, of exact-tour's")
        axes.set_title(f"{name_of(matrix)}: {of['columns'].iloc[0]:,} columns", fontsize=10)
    handles = [plt.Line2D([], [], color=c, marker="o", ms=4, label=f"k = {n}") for n, c in (("sample / 16", "#ef6c00"), ("sample / 4", "#42a5f5"), ("sample", "#7e57c2"))]
    handles += [plt.Line2D([], [], color=GREY, linestyle=":", label="without step 4's flips"), plt.Line2D([], [], color=GREY, label="with flips"),
                plt.Line2D([], [], color=RED, label="lower bound")]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=6, frameon=False)
    return figure


def draw_flann(results):
    """FLANN's indexes beside a scan of all columns: recall and time a query against dimension, a column of panels a density."""
    densities = sorted(results.flann.density.unique())
    figure, panels = plt.subplots(2, len(densities), figsize=(3.5 * len(densities), 5.6), squeeze=False, sharex=True, sharey="row", layout="constrained")
    indexes = list(dict.fromkeys(results.flann["index"]))
    styles = dict(zip(indexes, (("#777777", "s"), ("#1f4e79", "o"), ("#ef6c00", "^"), ("#7e57c2", "D"), ("#26a69a", "v"))))
    for column, density in enumerate(densities):
        for index, group in results.flann[results.flann.density == density].groupby("index", sort=False):
            group, (color, marker) = group.sort_values("rows"), styles[index]
            panels[0][column].plot(group.rows, 100 * group.recall, color=color, marker=marker, ms=5, linewidth=1)
            panels[1][column].plot(group.rows, group.us_per_query, color=color, marker=marker, ms=5, linewidth=1)
        panels[0][column].set_title(f"{density:.1%} ones", fontsize=10)
        panels[1][column].set_yscale("log")
        panels[1][column].set_xscale("log", base=2)
        panels[1][column].set_xticks(sorted(results.flann.rows.unique()), [f"{r:,}" for r in sorted(results.flann.rows.unique())])
    for axes in panels.flat:
        bare(axes)
        axes.grid(which="major", color="#e6e6e6")
    panels[0][0].set_ylabel("recall of the nearest, %")
    panels[1][0].set_ylabel("microseconds a query")
    figure.supxlabel("rows: the dimension of a column", fontsize=10)
    handles = [plt.Line2D([], [], color=styles[i][0], marker=styles[i][1], label=i) for i in indexes]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncol=5, frameon=False)
    return figure


CHARTS = {
    "runs_against_seconds": ("Runs against seconds, a panel a matrix; * is best, the red line is what no order can be below", draw_runs_against_seconds),
    "gap_against_seconds": ("The same near the bound: a dot a matrix and method", draw_gap_against_seconds),
    "bound_convergence": ("The lower bound's own convergence", draw_convergence),
    "distances": ("Fig. 6 of Chhugani et al. 2005 for our data: points near a random point, by number of points and by radius", draw_distances),
    "scale": ("Cost against size, up to the paper's", draw_scale),
    "walk": ("Disk reads of walks through levels, and bytes read, against a random layout (Fig. 12)", draw_walk),
    "failures_shapes": ("Matrices made to hurt", draw_shapes),
    "failures_samples": ("The printed method by sample size and k", draw_samples),
    "failures_flann": ("FLANN's indexes and a plain scan: recall and time by dimension and density", draw_flann),
}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """A run is a maximal group of ones in a row: a disk seek, or a pair of numbers in a code. <b>Fewer than random</b> is against the mean
over all orders, which is known exactly. <b>Above the bound</b> is against a proven lower bound on the runs of any order (Held and Karp's up
to 30,000 distinct columns): the best order possible is no further away than that. Each order is made in a process of its own, up to five
times within two seconds; <b>seconds</b> is the median by the wall, and <b>peak memory</b> holds the matrix too. * marks the fewest runs.
The levels' columns are clusters (cells) or faces. Published figures and the prototype's are in italics."""


WALK = """A viewer walks through a level from cell to touching cell; what appears and is not in memory is read from the disk, where the
level's faces lie in the order of each layout. A read goes on over as many unwanted pages as the read-ahead says."""


def sections(results):
    """Headings, words and tables, in the order of the page; a table may be a chart's name."""
    rows = results.matrices("rows")
    yield "Orders of columns", "", [*blocks_of_orders(results).items(), "runs_against_seconds", "gap_against_seconds", "bound_convergence"]
    if rows:
        yield "Orders of rows", "The same methods on the transposed matrix, and paper 002's greedy order among touching cells (neighbours).", \
            [*blocks_of_orders(results, "rows").items()]
    yield ("Beside the prototype", "Reference points measured before with other code; in brackets, of a random order's runs. The cities are other ones of the "
           "same numbers of columns, so only shares compare there. The prototype's sampled tour took 256 samples, k = 64, and flipped no edge.",
           [("", table_of_references(results))])
    yield ("At the paper's scale", "Fewer runs than in a random order: paper 000's method as printed, and ours, on synthetic scenes in the likeness of "
           "the paper's, calibrated so that the printed method reaches about what it was published to reach.",
           [("", table_of_paper(results)), ("", table_of_scale(results)), "scale"])
    yield ("Distances between points", "Of distinct columns: an equal one would be a nearest neighbour at distance 0. The paper's sample size grows with "
           "1 / alpha; the last column is by how much, for our data.", [("", table_of_alpha(results)), "distances"])
    if results.walk is not None:
        yield "Disk reads on a walk", WALK, [("", table_of_walk(results)), "walk"]
    yield ("Where methods fail", "", ["failures_shapes", "failures_samples", ("Spread over seeds", table_of_seeds(results)),
                                      ("Near columns found by sketches (nearby_points), of the ten nearest", table_of_recall(results)), "failures_flann"])


def main(out="out", records=None):
    results = load(out)
    charts = {name: (caption, draw(results)) for name, (caption, draw) in CHARTS.items() if name != "walk" or results.walk is not None}
    tools.write_report(out, "layout", "Orders of columns and rows, with lower bounds", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    main(*sys.argv[1:])
