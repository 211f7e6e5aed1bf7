"""The tables of orders of columns and rows: as ./reproduce layout wrote them, and as the report and the notebook show them."""
import pathlib
from dataclasses import dataclass

import numpy
import pandas as pd

import report_tools as tools
from report_tools import name_of


@dataclass
class Results:
    """The tables as the verbs of bench wrote them, and the published figures."""
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
    paper: pd.DataFrame

    def matrices(self, side="columns"):
        return list(dict.fromkeys(self.orders[self.orders.side == side].matrix))

    def side(self, matrix, side="columns"):
        """A matrix's methods, in the table's order."""
        return self.orders[(self.orders.matrix == matrix) & (self.orders.side == side)].set_index("method")


def load(out):
    folder = pathlib.Path(out) / "layout"
    read = tools.tables_of(folder)
    scale = pd.concat([read(path.stem) for path in sorted(folder.glob("scale_*.csv"))], ignore_index=True)
    scale = scale.sort_values(["scene", "harder", "scale"], ascending=[False, True, True], kind="stable")
    walk = read("disk_walk")
    if walk is not None:
        walk = walk.replace({"layout": {"identity": "natural"}})
    return Results(*map(read, ("orders", "orders_bounds", "distance_density", "distance_radius")), scale, walk,
                   *map(read, ("flann_recall", "failures_shapes", "failures_samples", "failures_seeds", "failures_recall")),
                   tools.published("orders_paper").set_index("scene"))


# ---- tables ----------------------------------------------------------------------------------------------------------------

MEASURES = {"runs": ("runs", "{:,.0f}"), "fewer than random, %": ("fewer_than_random", "{:.1f}"), "above the bound, %": ("gap", "{:.2f}"),
            "seconds": ("seconds_median", "{:.3f}"), "peak memory, MB": ("peak_bytes", "{:.0f}")}
SCALING = {"fewer_than_random": 100, "gap": 100, "peak_bytes": 1e-6}


def table_of_orders(results, side="columns"):
    """Methods by matrices, a block for each measure; a star marks the fewest runs."""
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
            row = {"": "lower bound", "measure": label}
            row |= {name_of(matrix).replace(".", "\n"): f"{results.side(matrix, side).bound.iloc[0]:,.0f}" for matrix in matrices}
            rows.append(row)
    return pd.DataFrame(rows)


def blocks_of_orders(results, side="columns"):
    """The same, as a table for each measure."""
    table = table_of_orders(results, side)
    return {label: table[table.measure == label].drop(columns="measure") for label in MEASURES}


def _scene(row):
    return name_of(row.scene) + (", harder" if row.harder else "")


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
        rows.append({"scene": name_of(scene), "": "published", "size": "1", "columns": f"{paper['columns']:,.0f}",
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
                         "runs": f"{row.runs:,}", "runs, of those in\na random order": f"{row.runs_per_random:.3f}",
                         "above the\nbound": f"{row.runs / bound - 1:.1%}" if bound > 0 else "-",
                         "bound": "-" if bound == 0 else "Held-Karp" if bound == row.held_karp else "two-nearest",
                         "seconds": f"{row.order_seconds:.2f}", "processor\nseconds": "-" if numpy.isnan(row.order_cpu_seconds) else f"{row.order_cpu_seconds:.2f}",
                         "peak GB": f"{row.peak_bytes / 1e9:.2f}",
                         "seconds grow\nlike ones^": growth("order_cpu_seconds") if last and row.method != "random" else "",
                         "memory grows\nlike ones^": growth("peak_bytes") if last else ""})
    return pd.DataFrame(rows)


def table_of_alpha(results):
    """Share of points within twice the nearest one's distance: the paper's alpha."""
    rows = [{"points": "published, both scenes", "columns": "400,000 and 790,000", "distinct": "-", "equal to\nanother": "-",
             "alpha": f"{results.paper.alpha.iloc[0]:.2f}", "median\npoint": "-", "samples by the\npaper's rule": "1 x"}]
    for matrix, group in results.density.groupby("matrix", sort=False):
        last = group.iloc[-1]
        rows.append({"points": name_of(matrix), "columns": f"{last['columns']:,}", "distinct": f"{last.distinct:,}",
                     "equal to\nanother": f"{last.with_an_equal:.1%}", "alpha": f"{last.within_twice:.4f}", "median\npoint": f"{last.within_twice_median:.4f}",
                     "samples by the\npaper's rule": f"{results.paper.alpha.iloc[0] / last.within_twice:,.0f} x"})
    return pd.DataFrame(rows)


def table_of_walk(results):
    """Disk reads on a walk through a level, with a column for each order; in brackets, how many fewer than in a random order."""
    rows = []
    for (matrix, page, ahead), group in results.walk.groupby(["matrix", "page_bytes", "read_ahead_pages"], sort=False):
        of = group.set_index("layout")
        rows.append({"level": matrix, "page": f"{page / 1024:g} KB", "read\nahead": f"{ahead}", "view cells\nentered": f"{of.steps.iloc[0]:,}",
                     "MB\nwanted": f"{of.bytes_wanted.iloc[0] / 1e6:.1f}", "MB read,\nrandom": f"{of.bytes_read['random'] / 1e6:.1f}",
                     "MB read,\nbest": f"{of.bytes_read['best'] / 1e6:.1f}",
                     **{f"reads,\n{order}": f"{reads:,} ({1 - reads / of.reads['random']:.1%})" if order != "random" else f"{reads:,}"
                        for order, reads in of.reads.items()}})
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
