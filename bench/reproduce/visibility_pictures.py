"""Pictures of the objects that `vismat see --producer sandwich` proves seen and hidden from a view cell, from above and in space.

Read are pairs of matrices NAME.effortN.bsp.h5 (-o) and NAME.effortN.seen.bsp.h5 (--seen). notebooks/visibility.ipynb imports this.
"""
import json
import pathlib
import re
from dataclasses import dataclass

import h5py
import matplotlib.pyplot as plt
import numpy
import pandas as pd
from matplotlib.collections import LineCollection, PolyCollection
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from report_tools import GREEN, ORANGE, RED, bare

SEEN, UNDECIDED, HIDDEN, CELL = GREEN, ORANGE, "#c9ced4", RED
COLOURS = (HIDDEN, UNDECIDED, SEEN)
NAMES = ("hidden", "undecided", "seen")
SIGHT_LINES = 40  # in one picture; more hide the objects


@dataclass
class Sandwich:
    """Both matrices of one run."""
    scene: str
    effort: int
    cells: numpy.ndarray        # boxes, as the next: low x, y, z, high x, y, z
    objects: numpy.ndarray
    state: numpy.ndarray        # [cells, objects]: 0 hidden, 1 undecided, 2 seen
    seen_pointers: numpy.ndarray
    sight_lines: numpy.ndarray  # for each entry of the seen matrix: a point of the cell, a point of the object
    degrees: numpy.ndarray      # for each entry too: its share of all directions

    def of_cell(self, values, cell):
        return values[self.seen_pointers[cell]:self.seen_pointers[cell + 1]]


def load(out):
    """All pairs in OUT/visibility/pictures, by scene and effort."""
    found = []
    for path in sorted((pathlib.Path(out) / "visibility" / "pictures").glob("*.effort*.seen.bsp.h5")):
        scene, effort = re.fullmatch(r"(.*)\.effort(\d)\.seen\.bsp\.h5", path.name).groups()
        with h5py.File(path) as seen, h5py.File(path.with_name(path.name.replace(".seen.", "."))) as listed:
            rows, columns = json.loads(seen.attrs["binsparse"])["binsparse"]["shape"]
            state = numpy.zeros((rows, columns), numpy.uint8)
            for value, file in ((1, listed), (2, seen)):
                state[numpy.repeat(numpy.arange(rows), numpy.diff(file["pointers_to_1"][:].astype(int))), file["indices_1"][:]] = value
            found.append(Sandwich(scene, int(effort), seen["vismat/row_bounds"][:], seen["vismat/column_bounds"][:], state, seen["pointers_to_1"][:].astype(int),
                                  seen["vismat/sight_lines"][:], seen["vismat/degree_of_visibility"][:]))
    return found


def typical_cell(of):
    """The view cell with the median number of undecided objects."""
    counts = (of.state == 1).sum(1)
    return int(numpy.argsort(counts, kind="stable")[len(counts) // 2])


def table_of_cells(runs):
    rows = []
    for of in runs:
        hidden, undecided, seen = ((of.state == value).sum(1).mean() for value in range(3))
        rows.append({"scene": of.scene, "effort": of.effort, "cells": len(of.cells), "objects": f"{len(of.objects):,}", "seen\nper cell": f"{seen:.1f}", "undecided": f"{undecided:.1f}",
                     "hidden": f"{hidden:.1f}", "undecided,\nof all objects": f"{undecided / len(of.objects):.2%}"})
    return pd.DataFrame(rows)


def draw_plan(axes, of, cell):
    """From above: object boxes, the high ones over the low ones, hidden ones below all; the cell; some sight lines."""
    state, boxes = of.state[cell], of.objects
    flat = numpy.prod(boxes[:, 3:5] - boxes[:, :2], axis=1) > .3 * numpy.prod(numpy.ptp(boxes.reshape(-1, 2, 3)[:, :, :2], axis=(0, 1)))
    for value in range(3):
        at = boxes[(state == value) & ~flat]
        at = at[numpy.argsort(at[:, 5], kind="stable")]
        corners = at[:, [0, 1, 3, 1, 3, 4, 0, 4]].reshape(-1, 4, 2)
        axes.add_collection(PolyCollection(corners, facecolors=COLOURS[value], edgecolors="white", linewidths=.3, zorder=1 + value))
    lines = of.of_cell(of.sight_lines, cell).reshape(-1, 2, 3)[:, :, :2]
    axes.add_collection(LineCollection(lines[::max(1, len(lines) // SIGHT_LINES)], colors="#222222", linewidths=.4, zorder=5))
    low_x, low_y, _, high_x, high_y, _ = of.cells[cell]
    axes.fill([low_x, high_x, high_x, low_x], [low_y, low_y, high_y, high_y], color=CELL, zorder=6)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    counts = ", ".join(f"{(state == value).sum():,} {NAMES[value]}" for value in (2, 1, 0))
    axes.set_title(f"{of.scene}, effort {of.effort}\n{counts}", fontsize=9, loc="left")


def legend(figure):
    handles = [plt.Line2D([], [], color=colour, marker="s", linestyle="", label=name)
               for name, colour in (("the view cell", CELL), ("seen: a sight line proves it", SEEN), ("undecided", UNDECIDED), ("hidden: a shadow proves it", HIDDEN))]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(.5, -.07), ncol=4, fontsize=9, frameon=False)


def draw_efforts(runs):
    """One view cell of one scene, at each effort."""
    figure, all_axes = plt.subplots(1, len(runs), figsize=(4.4 * len(runs), 5), squeeze=False, layout="constrained")
    for axes, of in zip(all_axes[0], runs):
        draw_plan(axes, of, typical_cell(runs[0]))
    legend(figure)
    return figure


def draw_slanting(of):
    """The same in space: seen and undecided objects as solid boxes, hidden ones as faint ones."""
    cell = typical_cell(of)
    figure = plt.figure(figsize=(7, 5), layout="constrained")
    axes = figure.add_subplot(projection="3d", computed_zorder=True)
    faces = numpy.array([[0, 1, 2], [3, 1, 2], [3, 4, 2], [0, 4, 2], [0, 1, 5], [3, 1, 5], [3, 4, 5], [0, 4, 5]])
    sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]]
    extent = numpy.concatenate([of.objects[:, :3].min(0), of.objects[:, 3:].max(0)])
    small = (of.objects[:, 3:5] - of.objects[:, :2]).max(1) < .5 * (extent[3:5] - extent[:2]).max()
    boxes = [(of.cells[cell], CELL, 1)] + [(box, COLOURS[value], .85 if value else .12) for box, value in zip(of.objects[small], of.state[cell][small])]
    for box, colour, alpha in boxes:
        axes.add_collection3d(Poly3DCollection(box[faces][sides], facecolors=colour, edgecolors="white", linewidths=.2, alpha=alpha))
    axes.set(xlim=extent[[0, 3]], ylim=extent[[1, 4]], zlim=extent[[2, 5]])
    axes.set_box_aspect(extent[3:] - extent[:3])
    axes.view_init(48, -60)
    axes.set_axis_off()
    axes.set_title(f"{of.scene}, effort {of.effort}", fontsize=9)
    legend(figure)
    return figure


def draw_counts(runs):
    """Undecided objects of each view cell, and the degree of visibility of the seen ones."""
    figure, (undecided, degree) = plt.subplots(1, 2, figsize=(11, 3.4), layout="constrained")
    for of, colour in zip(runs, plt.cm.viridis(numpy.linspace(0, .85, len(runs)))):
        name = f"{of.scene}, effort {of.effort}"
        undecided.hist(100 * (of.state == 1).mean(1), bins=20, histtype="step", color=colour, label=name)
        degrees = numpy.sort(of.degrees[of.degrees > 0])[::-1]
        degree.plot(numpy.arange(1, len(degrees) + 1) / len(of.cells), degrees, color=colour, label=name)
    undecided.set(xlabel="undecided objects, % of all", ylabel="number of view cells")
    degree.set(xscale="log", yscale="log", xlabel="seen objects of a view cell, largest first", ylabel="degree of visibility (share of all directions)")
    for axes in (undecided, degree):
        bare(axes)
        axes.legend(fontsize=8, frameon=False)
    return figure
