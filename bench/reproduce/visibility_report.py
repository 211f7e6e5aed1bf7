"""The report on visibility from view cells: over-estimation and missed objects against milliseconds, what accuracy depends on, where
producers fail: text, charts, one page.

    bench/reproduce/visibility_report.py [OUT [RECORDS]]   reads the tables that ./reproduce visibility wrote to OUT/visibility,
                                                           writes report.html, visibility.txt and the charts beside them,
                                                           prints the text, and keeps text and tables in RECORDS

Nothing here measures: every figure is read, or a sum or quotient of what is read.
"""
import pathlib
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy
import pandas as pd

import report_tools as tools
from report_tools import BLUE, GREEN, GREY, ORANGE, RED, bare, legend_below, plain_ticks

LOOKS = {"shadow": (BLUE, "o"), "sampled": (ORANGE, "s"), "sandwich": (GREEN, "D")}
BENCHMARK = "dense-city"
# For effort 0, 1 and 2: the producer, and the goals: milliseconds for a view cell, over-estimation, share found and share undecided of all objects.
GOALS = [("shadow", 10, 2.0, None, None), ("sandwich", 150, 1.4, .95, None), ("sandwich", 1000, None, None, .02)]


@dataclass
class Results:
    """The tables as the verbs of bench wrote them, None where one was not run; and the published figures."""
    tables: pd.DataFrame           # bench visibility-tables: a line for each scene, producer and setting
    failures: pd.DataFrame | None  # bench visibility-failures, this and the next
    detail: pd.DataFrame | None
    octree: pd.DataFrame | None    # bench octree-tables
    published: pd.DataFrame


def load(out):
    read = tools.tables_of(pathlib.Path(out) / "visibility")
    return Results(*map(read, ("tables", "failures", "detail", "octree")), tools.published("vlod2005_visibility").set_index("figure"))


# ---- tables ----------------------------------------------------------------------------------------------------------------

def show(value, form):
    return "" if pd.isna(value) else form.format(value)


def table_of_goals(results):
    """The goals that we set before measuring, on the dense city."""
    rows = []
    of = results.tables[results.tables.scene == BENCHMARK]
    for tier, (producer, ms, over, found, undecided) in enumerate(GOALS):
        lines = of[(of.producer == producer) & of.settings.str.contains(f"effort {tier}")]
        if lines.empty:
            continue
        line = lines.iloc[0]
        checks = [("ms per view cell", line.ms_median, ms, "{:.1f}", "at most {:g}", line.ms_median <= ms)]
        if over:
            checks.append(("over-estimation", line.over_estimation, over, "{:.2f}x", "at most {:.1f}x", line.over_estimation <= over))
        if found:
            checks.append(("found", line.found, found, "{:.1%}", "at least {:.0%}", line.found >= found))
        if undecided:
            checks.append(("undecided", line.undecided, undecided, "{:.2%}", "at most {:.0%}", line.undecided <= undecided))
        checks.append(("wrongly hidden", line.wrongly_hidden, 0, "{:.0f}", "{:g}", line.wrongly_hidden == 0))
        for name, value, goal, form, goal_form, met in checks:
            rows.append({"effort": f"{tier}: {producer}", "measure": name, "ours": form.format(value), "goal": goal_form.format(goal), "met": "yes" if met else "no"})
    return pd.DataFrame(rows)


def table_of_runs(results, scene):
    of = results.tables[results.tables.scene == scene]
    return pd.DataFrame([{"producer": row.producer, "settings": row.settings, "ms per cell,\nmedian": f"{row.ms_median:.1f}", "ms, least\nto most": f"{row.ms_least:.1f} to {row.ms_most:.1f}",
                          "not hidden": show(row.not_hidden, "{:.1f}"), "seen": show(row.seen, "{:.1f}"), "reference": f"{row.reference:.1f}",
                          "over-\nestimation": show(row.over_estimation, "{:.2f}x"), "found": show(row.found, "{:.1%}"),
                          "undecided,\nof all objects": show(row.undecided if row.producer == "sandwich" else numpy.nan, "{:.2%}"),
                          "wrongly\nhidden": show(row.wrongly_hidden, "{:.0f}")} for row in of.itertuples()])


def table_of_points(results):
    """Objects not hidden from one projection point, compared with a random point."""
    rows = []
    points = results.tables[results.tables.producer == "point"]
    for scene, of in points.groupby("scene", sort=False):
        by = of.set_index("settings").not_hidden
        rows.append({"scene": scene, "random": f"{by['random']:.1f}", **{name: f"{by[name]:.1f} ({by[name] / by['random'] - 1:+.1%})" for name in by.index if name != "random"}})
    table = pd.DataFrame(rows)
    table.columns = [name.replace(" (published)", "\n(the paper's objective)").replace(" (ours)", "\n(our objective)") for name in table.columns]
    return table


def table_beside_published(results):
    """The published figures, each beside the nearest of ours."""
    of = results.tables[results.tables.wrongly_hidden.notna()]
    single = of[(of.producer == "shadow") & of.settings.str.contains("effort 0")]
    published = results.published.words
    rows = [("ms per view cell, one core", published.ms_a_cell, f"{single.ms_median.min():.1f} to {single.ms_median.max():.1f} ms", "effort 0, the scenes of this page, on current hardware"),
            ("over-estimation", published.over_estimation, f"{single.over_estimation.min():.2f} to {single.over_estimation.max():.2f} times", "effort 0; the reference is at least 4 million rays from each view cell, not 125 points")]
    points = results.tables[results.tables.producer == "point"].pivot_table(index="scene", columns="settings", values="not_hidden")
    if len(points):
        fewer = 1 - points["apexes (published)"] / points["random"]
        rows.append(("fewer objects than from a random point", published.fewer, f"{fewer.min():.1%} to {fewer.max():.1%}", "with the paper's objective; ours is in the table of projection points"))
    if results.octree is not None:
        last = results.octree.loc[results.octree.groupby(["scene", "threshold"])["level"].idxmax()]
        last = last[last.stopped > 0]
        share = last.stopped / last.kept
        rows.append(("smallest octree cells above the threshold", published.stopped, f"{share.min():.0%} to {share.max():.0%}", "depends on the threshold and the levels, which the paper does not give"))
        rows.append(("their triangles, times the threshold", published.excess, f"{last.excess.min():.2f} to {last.excess.max():.2f}", ""))
    return pd.DataFrame(rows, columns=["measure", "published", "ours", "note"])


def table_of_failures(results, studies):
    of = results.failures[results.failures.study.isin(studies)].fillna({"value": ""})
    return pd.DataFrame([{"study": row.study, "": str(row.value), "occluders": row.settings, "triangles": f"{row.triangles:,}", "not hidden": f"{row.not_hidden:.1f}", "reference": f"{row.reference:.1f}",
                          "over-\nestimation": f"{row.over_estimation:.2f}x", "wrongly\nhidden": f"{row.wrongly_hidden:.0f}", "ms per\ncell": f"{row.ms_median:.1f}"} for row in of.itertuples()])


def table_of_detail(results):
    return pd.DataFrame([{"rule": row.rule, "objects": f"{row.objects:,}", "drawn coarser": f"{row.coarser:,}", "triangles of\nthe finest level": f"{row.triangles_full:,}", "triangles\ndrawn": f"{row.triangles:,}",
                          "median error,\npixels": f"{row.median_pixels:.3f}", "largest error,\npixels": f"{row.most_pixels:.3f}", "objects over\none pixel": f"{row.over_one_pixel:,}"} for row in results.detail.itertuples()])


def table_of_octree(results):
    rows = []
    for row in results.octree.itertuples():
        rows.append({"scene": row.scene, "threshold": f"{row.threshold:,}", "cells": f"{row.cells:,}", "triangles\nper cell": f"{row.mean_triangles:,.0f}", "level": row.level, "side, m": f"{row.side:.1f}", "evaluated": f"{row.evaluated:,}",
                     "kept": f"{row.kept:,}", "stopped": f"{row.stopped:,}", "of kept": f"{row.stopped / row.kept:.0%}" if row.kept else "", "excess": f"{row.excess:.2f}x" if row.stopped else ""})
    return pd.DataFrame(rows)


# ---- charts ----------------------------------------------------------------------------------------------------------------

def draw_tiers(results):
    """A column for each scene: above over-estimation, below missed objects, against milliseconds for a view cell."""
    scenes = list(dict.fromkeys(results.tables.scene))
    figure, all_axes = plt.subplots(2, len(scenes), figsize=(3.1 * len(scenes) + .8, 6.4), squeeze=False, layout="constrained", sharex="col")
    for i, (scene, (above, below)) in enumerate(zip(scenes, all_axes.T)):
        of = results.tables[results.tables.scene == scene]
        for producer, (colour, marker) in LOOKS.items():
            line = of[of.producer == producer].sort_values("ms_median")
            above.plot(line.ms_median, line.over_estimation, color=colour, marker=marker, markersize=5, linewidth=.8, linestyle=":" if producer == "shadow" else "-")
            missed = line[line.found.notna()]
            below.plot(missed.ms_median, 100 * (1 - missed.found), color=colour, marker=marker, markersize=5, linewidth=.8)
            for row in line.itertuples():
                if "effort" in row.settings:
                    above.annotate(row.settings[row.settings.index("effort") + 7], (row.ms_median, row.over_estimation), xytext=(0, 5), textcoords="offset points", ha="center", fontsize=8, fontweight="bold", color=colour)
                    if not pd.isna(row.found):
                        below.annotate(row.settings[row.settings.index("effort") + 7], (row.ms_median, 100 * (1 - row.found)), xytext=(0, 5), textcoords="offset points", ha="center", fontsize=8, fontweight="bold", color=colour)
        if scene == BENCHMARK:
            for _, ms, over, found, _ in GOALS:
                if over:
                    above.plot(ms, over, marker="x", color=RED, markersize=7, markeredgewidth=1.8)
                if found:
                    below.plot(ms, 100 * (1 - found), marker="x", color=RED, markersize=7, markeredgewidth=1.8)
        above.axhline(1, color=GREY, linewidth=.8)
        above.set(xscale="log", yscale="log")
        above.set_ylim(.95, max(2.2, 1.15 * of.over_estimation.max()))
        below.set_xscale("log")
        plain_ticks(above.yaxis, "x", (1, 1.5, 2, 3, 5) if of.over_estimation.max() < 12 else (1, 2, 5))
        plain_ticks(below.xaxis, "", (1,))
        below.set_ylim(0, None)
        objects = of.objects.iloc[0]
        above.set_title(f"{scene}\n{of.triangles.iloc[0]:,} triangles, {objects:,} objects", fontsize=9, loc="left")
        below.set_xlabel("milliseconds of one core for a view cell")
        if i == 0:
            above.set_ylabel("objects not proven hidden,\nin multiples of the reference")
            below.set_ylabel("visible objects missed, %")
        for axes in (above, below):
            bare(axes)
            axes.grid(alpha=.25)
    handles = [plt.Line2D([], [], color=colour, marker=marker, markersize=5, linewidth=.8, label={"shadow": "shadow (proves hidden)", "sampled": "sampled (proves seen)", "sandwich": "sandwich (both)"}[name]) for name, (colour, marker) in LOOKS.items()]
    handles.append(plt.Line2D([], [], color=RED, marker="x", linestyle="", label="goals on the dense city (digits are the effort)"))
    legend_below(figure, handles, 4, fontsize=9)
    return figure


def draw_accuracy(results):
    """Over-estimation on the dense city: against raster, view cell and triangle size, and by kind of occluder."""
    failures = results.failures
    studies = set(failures.study)
    figure, all_axes = plt.subplots(1, 4, figsize=(15, 3.9), layout="constrained", width_ratios=(1, 1, 1, 1.2))
    raster, cell, triangles, kinds = all_axes
    if "raster" in studies:
        of = failures[failures.study == "raster"]
        raster.plot(of.settings.astype(float), of.over_estimation, color=BLUE, marker="o")
        for row in of.itertuples():
            raster.annotate(f"{row.ms_median:.0f} ms", (float(row.settings), row.over_estimation), xytext=(0, 6), textcoords="offset points", ha="center", fontsize=7)
        raster.set(xscale="log", xlabel="side of a face of the cube map, pixels")
        raster.set_xticks(of.settings.astype(float), of.settings.astype(str))
        raster.xaxis.set_minor_locator(plt.NullLocator())
        raster.set_ylim(1, 1.1 * of.over_estimation.max())
    if "cell" in studies:
        of = failures[failures.study == "cell"]
        for producer, group in of.groupby("producer", sort=False):
            cell.plot(group.value.astype(float), group.over_estimation, color=LOOKS[producer][0], marker=LOOKS[producer][1], label=group.settings.iloc[0])
        cell.set(xscale="log", yscale="log", xlabel="side of the view cells, m")
        cell.set_xticks([.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
        cell.xaxis.set_minor_locator(plt.NullLocator())
        plain_ticks(cell.yaxis, "x", (1, 1.5, 2, 3, 5))
        cell.legend(fontsize=8, frameon=False)
    if "triangles" in studies:
        of = failures[failures.study == "triangles"]
        for settings, group in of.groupby("settings", sort=False):
            triangles.plot(group.value.astype(float), group.over_estimation, color=BLUE if settings == "occluders" else RED, marker="o", label={"occluders": "solids and flat faces"}.get(settings, settings))
        triangles.set(xscale="log", yscale="log", xlabel="longest leg of a triangle of the walls, m")
        steps = sorted(of.value.astype(float).unique())
        triangles.set_xticks(steps, [f"{step:g}" for step in steps])
        triangles.xaxis.set_minor_locator(plt.NullLocator())
        plain_ticks(triangles.yaxis, "x", (1, 2, 5))
        triangles.legend(fontsize=8, frameon=False)
    if "occluders" in studies:
        of = failures[failures.study == "occluders"]
        places = numpy.arange(len(of))[::-1]
        kinds.barh(places, of.over_estimation, color=[RED if name == "single triangles" else BLUE for name in of.settings], height=.65)
        for place, row in zip(places, of.itertuples()):
            kinds.text(row.over_estimation, place, f" {row.over_estimation:.2f}x", va="center", fontsize=8)
        kinds.set(yticks=places, xlabel="objects not proven hidden, in multiples of the reference", xscale="log", xlim=(1, 1.6 * of.over_estimation.max()))
        kinds.set_yticklabels(of.settings, fontsize=8)
        plain_ticks(kinds.xaxis, "x", (1, 2, 5))
    raster.set_ylabel("objects not proven hidden,\nin multiples of the reference")
    for axes in all_axes:
        bare(axes)
        axes.grid(alpha=.25)
    return figure


CHARTS = {
    "visibility_tiers": ("Over-estimation and missed objects against milliseconds for a view cell, with a column for each scene and a mark for each setting", draw_tiers, ("tables",)),
    "visibility_accuracy": ("What over-estimation depends on: the dense city at effort 0 unless another effort is named", draw_accuracy, ("failures",)),
}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """For view cells spread over each scene, a producer classifies every object: it is proven <b>hidden</b>, proven <b>seen</b>, or neither. The
<b>reference</b> is the set of objects that at least one of about four million rays from the view cell, or any producer, saw. It is smaller than the true visible set, so
<b>over-estimation</b>, the number of objects not proven hidden divided by that of the reference, looks worse than it is. <b>Found</b> is the share of the
reference that was proven seen. <b>Undecided</b> objects are neither hidden nor seen, as a share of all objects of the scene. <b>Wrongly hidden</b>
objects are reported hidden although they are in the reference; bench ends with an error if there is one. Milliseconds are processor time of
one thread, so other work on the machine does not count, although it may slow caches and shared cores. They do not include the preparation of
the scene. Published figures are in italics."""


def sections(results):
    """As report_tools.as_text wants them."""
    goals = table_of_goals(results)
    yield ("Over-estimation and missed objects against milliseconds for a view cell", "",
           ["visibility_tiers", *([("Goals that we set before measuring, on the dense city", goals)] if len(goals) else []),
            ("Comparison with the published figures", table_beside_published(results))])
    yield ("Projection points", "Mean number of objects not hidden at effort 0 from one point of the view cell; in brackets the change against a random point.",
           [("", table_of_points(results))])
    if results.failures is not None:
        yield "What accuracy depends on", "", ["visibility_accuracy", ("", table_of_failures(results, ["raster", "cell", "triangles", "occluders"]))]
        yield ("Where producers fail", "A wall in front of a view cell of 2 m, with 81 boxes behind it. For far coordinates, a city of 8 x 8 squares is moved.",
               [("", table_of_failures(results, [name for name in dict.fromkeys(results.failures.study) if name not in ("raster", "cell", "triangles", "occluders")]))])
    if results.detail is not None:
        yield ("Levels of detail", "The distance between vertices of the finest level and the level that is drawn, seen from the corners of the view cell, in pixels of a picture of 1920 x 1080.", [("", table_of_detail(results))])
    if results.octree is not None:
        yield "The adaptive octree", "A view cell is divided as long as it sees more triangles than the threshold. The limit on levels stopped some of the smallest above it; excess is the mean number of their triangles divided by the threshold.", [("", table_of_octree(results))]
    yield "Every setting", "", [(scene, table_of_runs(results, scene)) for scene in dict.fromkeys(results.tables.scene)]


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "visibility", "Visibility from view cells", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
