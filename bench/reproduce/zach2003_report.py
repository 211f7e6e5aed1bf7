"""Tables 1 and 2 of Zach and Karner 2003, our data beside the published figures: text, charts, one page.

    bench/reproduce/zach2003_report.py [OUT [RECORDS]]   reads the tables that ./reproduce zach2003 wrote to OUT/zach2003, writes
                                                         report.html, zach2003.txt and the charts beside them, prints the
                                                         text, and keeps text and tables in RECORDS

The notebook imports the same functions. Nothing here measures: every figure is read, and every ratio is table size / bytes.
"""
import pathlib
import textwrap
from dataclasses import dataclass

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.patches import Patch

import report_tools as tools
from report_tools import OURS, THEIRS, bare, name_of, plain_ticks

# What the paper calls each row of Table 2. It measured Huffman codes for methods 3 and 4 after the greedy order of the view
# cells, so those are compared; it only calculated what arithmetic coding would give (13-15 % less for method 3), and only
# mentioned the order by neighbours alone (section 4.2).
METHODS = {"gzip": "gzip", "bzip2": "bzip2", "zach0": "method 0", "zach1": "method 1", "zach2": "method 2",
           "zach3": "method 3", "zach4": "method 4"}
OURS_ONLY = {"zach3-neighbours": "method 3, neighbours", "zach3-range": "method 3, range coder",
             "zach4-range": "method 4, range coder", "quake-rle": "Quake RLE"}
# Our codec and order of view cells for each of them: gzip and bzip2 take the natural order, methods 0 to 2 do not depend on it.
MEASURED = {("zach3-huffman", "greedy"): "zach3", ("zach4-huffman", "greedy"): "zach4", ("zach3-range", "greedy"): "zach3-range",
            ("zach4-range", "greedy"): "zach4-range", ("zach3-huffman", "neighbours"): "zach3-neighbours",
            **{(codec, "natural"): codec for codec in ("bitmap", "quake-rle", "gzip", "bzip2", "zach0", "zach1", "zach2")}}
SCENES = ("artificial-1", "artificial-2", "inner-city", "complete")  # of the paper
FAR = 4 / 3  # a ratio further than this from the published one is explained in the notebook


@dataclass
class Results:
    """scenes: Table 1, sizes: Table 2 with a row for each matrix and codec; each ours and as published, the same columns.
    structure: what table_structure.py measured of each matrix."""
    scenes: pd.DataFrame
    sizes: pd.DataFrame
    published_scenes: pd.DataFrame
    published_sizes: pd.DataFrame
    structure: pd.DataFrame

    @property
    def levels(self):
        return [m for m in self.scenes.index if m not in SCENES]

    @property
    def artificial(self):
        return [m for m in SCENES if m in self.scenes.index]


def load(out):
    """Reads what zach-tables and table_structure.py wrote into the folder OUT/zach2003, and the published figures."""
    def scenes(table):
        return table.sort_values("matrix", kind="stable").set_index("matrix")

    def sizes(table):
        if "order" in table:
            keys = [MEASURED.get(key) for key in zip(table["codec"], table["order"])]
            table = table.assign(codec=keys).dropna(subset="codec")
        table = table.set_index(["matrix", "codec"])
        table["ratio"] = table.index.get_level_values("matrix").map(table["bytes"].xs("bitmap", level="codec")) / table["bytes"]
        return table

    read = tools.tables_of(pathlib.Path(out) / "zach2003")
    return Results(scenes(read("zach2003_scenes")), sizes(read("zach2003")), scenes(tools.published("zach2003_scenes")),
                   sizes(tools.published("zach2003")), scenes(read("zach2003_structure")))


# ---- tables ----------------------------------------------------------------------------------------------------------------

def table1(results):
    """Scene characteristics, with rows for each scene: ours and, where the paper has it, the published one below."""
    rows = []
    for name in [*SCENES, *results.levels]:
        for whose, table in (("ours", results.scenes), ("published", results.published_scenes)):
            if name in table.index:
                scene = table.loc[name]
                rows.append({"scene": name_of(name), "": whose, "view cells": f"{scene.view_cells:,.0f}",
                             "occludees": f"{scene.occludees:,.0f}", "average visibility": f"{scene.average_visibility:.1%}"})
    return pd.DataFrame(rows)


def _size(table, name, codec):
    if (name, codec) not in table.index:
        return "-"
    entry = table.loc[(name, codec)]
    return f"{entry.bytes:,.0f}" + ("" if codec == "bitmap" else f" ({entry.ratio:.1f}x)")


def _run(table, name, codec):
    run = table["average_run"].get((name, codec), float("nan"))
    return "-" if pd.isna(run) else f"{run:.2f}"


def table2(results):
    """The paper's four scenes: bytes, and how many times smaller than the table."""
    columns = {(name_of(name), whose): (name, table)
               for name in SCENES for whose, table in (("ours", results.sizes), ("published", results.published_sizes))
               if name in table.index.get_level_values("matrix")}
    rows = {"table size": "bitmap", **{label: codec for codec, label in {**METHODS, **OURS_ONLY}.items()}}
    table = pd.DataFrame({"\n".join(column): [_size(of, name, codec) for codec in rows.values()]
                          for column, (name, of) in columns.items()}, index=list(rows))
    for codec in ("zach3", "zach4"):
        table.loc[f"{METHODS[codec]}, average run"] = [_run(of, name, codec) for name, of in columns.values()]
    for label, column in (("greedy order, beside method 3", "order_bytes"), ("node index, beside method 3", "index_bytes")):
        table.loc[label] = [f"{of[column][(name, 'zach3')]:,}" if column in of else "-" for name, of in columns.values()]
    return table.rename_axis("bytes (ratio)").reset_index()


def contents(results):
    """What the bytes of each row of Table 2 hold: pairs of a row's name and words."""
    holds = results.sizes["payload_contains"].groupby(level="codec").first()
    return [*((label, holds[codec]) for codec, label in {**METHODS, **OURS_ONLY}.items() if codec in holds),
            ("on lines of their own", "the order of the view cells (log2 n! bits), the node index (a varint for each part)"),
            ("not counted", "the tree, which a program that draws the scene has anyway, and the geometry of the view cells")]


def table2_levels(results):
    """Real levels, with a row for each: the table's bytes and each method's ratio; * marks the smallest of what the paper compares."""
    rows = []
    for name in results.levels:
        ratios = {codec: results.sizes["ratio"].get((name, codec)) for codec in (*METHODS, *OURS_ONLY)}
        best = max((r for codec, r in ratios.items() if codec in METHODS and r is not None), default=None)
        row = {"level": name, "table size": f"{results.sizes['bytes'][(name, 'bitmap')]:,}"}
        for codec, label in {**METHODS, **OURS_ONLY}.items():
            ratio = ratios[codec]
            mark = "*" if codec in METHODS and ratio == best else ""
            row[label.replace(", ", "\n").replace(" coder", "")] = "-" if ratio is None else f"{ratio:.1f}x{mark}"
        rows.append(row)
    return pd.DataFrame(rows)


def ranking(table, name):
    """The compared methods, smallest first."""
    sizes = table["bytes"].xs(name, level="matrix")
    return [METHODS[codec] for codec in sizes[sizes.index.isin(list(METHODS))].sort_values(kind="stable").index]


def far_from_published(results):
    """Each ratio that differs from the published one by more than a third, either way."""
    both = results.sizes[["bytes", "ratio"]].join(results.published_sizes[["bytes", "ratio"]], rsuffix="_published", how="inner")
    both = both[both.index.get_level_values("codec").isin(list(METHODS))]
    both["ours_to_published"] = both["ratio"] / both["ratio_published"]
    return both[(both.ours_to_published > FAR) | (both.ours_to_published < 1 / FAR)]


def other_rankings(results):
    """Each scene of ours and pair of methods where the one that comes later in the paper is the smaller one here: by how many
    per cent, and what may be behind it. Levels are held against the one order that both real scenes of the paper share."""
    rows = []
    for name in [*results.artificial, *results.levels]:
        expected = ranking(results.published_sizes, name if name in SCENES else "inner-city")
        sizes = results.sizes["bytes"].xs(name, level="matrix").rename(METHODS)
        for i, later in enumerate(expected):
            for earlier in expected[:i]:
                if sizes[later] < sizes[earlier]:
                    rows.append({"scene": name, "pair": f"{later} smaller than {earlier}", "smaller by, %": 100 * (1 - sizes[later] / sizes[earlier]),
                                 "table, kB": sizes["bitmap"] / 1e3, **results.structure.loc[name]})
    return pd.DataFrame(rows, columns=["scene", "pair", "smaller by, %", "table, kB", *results.structure.columns])


def structure_with_and_without(results):
    """For each pair of other_rankings: medians over the levels that have it, and over the other levels."""
    turned = other_rankings(results)
    levels = results.structure.loc[results.levels].drop(columns="bzip2_distinct")
    levels["table, kB"] = results.sizes["bytes"].xs("bitmap", level="codec") / 1e3
    rows = [{"pair": pair, "": whose, "levels": len(part), **part.median()}
            for pair, group in turned[turned["scene"].isin(results.levels)].groupby("pair")
            for whose, part in (("other order", levels.loc[group["scene"]]), ("published order", levels.drop(group["scene"])))]
    return pd.DataFrame(rows)


def runs_against_published(results):
    """Method 3 on the artificial scenes: how much shorter our average run is than the published one, and how much more it takes."""
    ours, theirs = (table.xs("zach3", level="codec") for table in (results.sizes, results.published_sizes))
    return pd.DataFrame({"average run": ours["average_run"], "published": theirs["average_run"],
                         "published / ours": theirs["average_run"] / ours["average_run"],
                         "bytes / published bytes": ours["bytes"] / theirs["bytes"]}).loc[results.artificial]


def arithmetic_coding(results):
    """Method 3 in greedy order: bytes with Huffman codes, the entropy of the one histogram of all lengths (which the paper
    calculated), bytes with the range coder, and what that saves over Huffman codes."""
    huffman, coded = (results.sizes.xs(codec, level="codec") for codec in ("zach3", "zach3-range"))
    return pd.DataFrame({"Huffman codes": huffman["bytes"], "entropy": huffman["entropy_bytes"], "range coder": coded["bytes"],
                         "range coder saves, %": 100 * (1 - coded["bytes"] / huffman["bytes"])})


def cost_of_repeats(results):
    """What leaving out repeated columns saves bzip2: the part of the columns, and the part of its bytes."""
    whole = results.sizes["bytes"].xs("bzip2", level="codec")
    return pd.DataFrame({"columns that repeat, %": 100 * (1 - results.structure["distinct_columns"]),
                         "bzip2's bytes for them, %": 100 * (1 - results.structure["bzip2_distinct"] / whole)})


# ---- charts ----------------------------------------------------------------------------------------------------------------

def draw_ratios(results):
    """Bars, with a panel for each artificial scene: our ratio beside the published one."""
    figure, panels = plt.subplots(1, max(1, len(results.artificial)), figsize=(5.6 * max(1, len(results.artificial)), 4),
                                  squeeze=False, layout="constrained")
    for axes, name in zip(panels[0], results.artificial):
        bare(axes)
        for i, codec in enumerate(METHODS):
            for offset, table, style in ((-0.2, results.sizes, OURS), (0.2, results.published_sizes, THEIRS)):
                ratio = table["ratio"].get((name, codec), float("nan"))
                if pd.isna(ratio):
                    continue
                axes.bar(i + offset, ratio, 0.4, **style)
                axes.text(i + offset, ratio, f"{ratio:.1f}", ha="center", va="bottom", fontsize=7.5)
        axes.set_xticks(range(len(METHODS)), [label.replace(" ", "\n") for label in METHODS.values()], fontsize=9)
        axes.set_title(name_of(name), fontsize=11)
        axes.grid(axis="y", color="#dddddd")
        axes.set_ylabel("table size / compressed size")
        axes.legend(handles=[Patch(label="ours", **OURS), Patch(label="published 2003", **THEIRS)],
                    loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2, frameon=False)
    return figure


def draw_levels(results):
    """A dot for each level and method, and a bar at the median; the paper's two real scenes beside them."""
    methods = {**METHODS, **OURS_ONLY}
    figure, axes = plt.subplots(figsize=(10, 4.6), layout="constrained")
    bare(axes)
    for i, codec in enumerate(methods):
        ratios = sorted(r for (name, c), r in results.sizes["ratio"].items() if c == codec and name not in SCENES)
        spread = [i + 0.28 * ((k % 7) / 3 - 1) for k in range(len(ratios))]
        axes.scatter(spread, ratios, s=14, color=OURS["facecolor"], alpha=0.6, linewidths=0)
        if ratios:
            axes.hlines(pd.Series(ratios).median(), i - 0.36, i + 0.36, color="black", linewidth=1.6)
        for name, marker in (("inner-city", "D"), ("complete", "s")):
            if (name, codec) in results.published_sizes.index:
                axes.scatter(i + 0.42, results.published_sizes["ratio"][(name, codec)], s=34, marker=marker, facecolors="white",
                             edgecolors="#333333", zorder=3)
    axes.set_yscale("log")
    plain_ticks(axes.yaxis, "x")
    axes.set_ylabel("table size / compressed size")
    axes.set_xticks(range(len(methods)), [textwrap.fill(label.replace(",", ""), 10) for label in methods.values()], fontsize=9)
    axes.grid(axis="y", which="both", color="#e6e6e6")
    handles = [plt.Line2D([], [], marker="o", ls="", color=OURS["facecolor"], label=f"a real level ({len(results.levels)})"),
               plt.Line2D([], [], color="black", label="their median"),
               *(plt.Line2D([], [], marker=m, ls="", mfc="white", mec="#333333", label=f"{n}, published 2003")
                 for n, m in (("inner city", "D"), ("complete", "s")))]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncol=4, frameon=False)
    return figure


def draw_bytes_against_visibility(results):
    """Each matrix's bytes against its average visibility: the table, gzip and method 3 on one vertical line."""
    figure, axes = plt.subplots(figsize=(9, 6.4), layout="constrained")
    bare(axes)
    markers = {"bitmap": "_", "gzip": "x", "zach3": "o"}
    labels = []
    few = len(results.levels) <= 16
    for scenes, sizes, color, filled in ((results.scenes, results.sizes, OURS["facecolor"], True),
                                         (results.published_scenes, results.published_sizes, "#333333", False)):
        for name, scene in scenes.iterrows():
            x = 100 * scene.average_visibility
            points = {codec: sizes["bytes"][(name, codec)] for codec in markers if (name, codec) in sizes.index}
            if x <= 0 or not points:
                continue
            axes.vlines(x, min(points.values()), max(points.values()), color=color, linewidth=0.7, alpha=0.6 if few else 0.2,
                        linestyle="-" if filled else ":")
            for codec, size in points.items():
                axes.scatter(x, size, s=36 if few or name in SCENES else 10, marker=markers[codec], linewidths=1.2, color=color,
                             facecolors=(color if filled else "white") if codec == "zach3" else None, zorder=3)
            if few or name in SCENES:
                labels.append((x, max(points.values()), name_of(name) + ("" if filled else ", published"), color))
    axes.set_xscale("log")
    axes.set_yscale("log")
    _label_above(axes, labels)
    plain_ticks(axes.xaxis, " %", (1, 1.5, 2, 3, 5, 7))
    axes.set_xlabel("average visibility: ones / (rows x columns), per cent")
    axes.set_ylabel("bytes")
    axes.grid(which="major", color="#e6e6e6")
    handles = [plt.Line2D([], [], marker=marker, ls="", color=OURS["facecolor"], label=label)
               for marker, label in (("_", "table, 1 bit for each entry"), ("x", "gzip"), ("o", "method 3"))]
    handles.append(plt.Line2D([], [], marker="o", ls=":", color="#333333", mfc="white", label="published 2003"))
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncol=4, frameon=False)
    return figure


def _label_above(axes, labels, gap=0.042):
    """Names of points, (x, y, name, color) each, in a row above the axes, far enough apart to read; a thin line leads to each."""
    labels = sorted(labels)
    to_fraction = axes.transData + axes.transAxes.inverted()
    places = [to_fraction.transform((x, y))[0] for x, y, _, _ in labels]
    for i in range(1, len(places)):
        places[i] = max(places[i], places[i - 1] + gap)
    for i in reversed(range(len(places))):
        places[i] = min(places[i], 1 - (len(places) - 1 - i) * gap)
    for place, (x, y, name, color) in zip(places, labels):
        axes.annotate("", (x, y), xytext=(place, 1), textcoords="axes fraction", annotation_clip=False,
                      arrowprops=dict(arrowstyle="-", color="#bbbbbb", linewidth=0.6, shrinkA=0, shrinkB=2))
        axes.text(place, 1.01, name, transform=axes.transAxes, rotation=60, fontsize=8, color=color, ha="left", va="bottom",
                  rotation_mode="anchor")


CHARTS = {
    "ratios": ("Compression ratio on the artificial scenes", draw_ratios, []),
    "levels": ("Compression ratio on real levels", draw_levels, ["levels"]),
    "bytes_against_visibility": ("Bytes against average visibility", draw_bytes_against_visibility, []),
}


# ---- the page --------------------------------------------------------------------------------------------------------------

HOW_TO_READ = """A visibility matrix has a row for each view cell and a column for each node of a tree over the scene's objects; a one
says that the node may be seen from the view cell. <b>Table size</b> is one bit for each entry, with rows padded to bytes.
Each other figure is the bytes of a payload that was decoded again and compared; in brackets, how many times smaller than the table
that is (5.2x: the table takes 5.2 times as much). gzip and bzip2 compress the whole table; methods 0 to 4 store each node's
visibility on its own. For methods 3 and 4 the view cells are reordered first. That order takes bytes, and so does an index of
where each node's part begins, if the parts are kept in one file: both stand on lines of their own and, as in the paper, in no
other figure. The range-coded variants are what the paper calculated but did not build. <b>Published</b> figures (hatched or hollow
in the charts) are of other data: we rebuilt the artificial scenes from the paper's description, the city of Graz is not available,
and the paper has no levels of games. A level's view cells are its clusters (Quake) or sectors (Doom); its columns are the nodes of a
tree of bounding boxes over its view cells (NAME.cells) or faces (NAME.faces)."""


def sections(results):
    """As report_tools.as_text wants them."""
    holds = pd.DataFrame(contents(results), columns=["line", "what the bytes hold"])
    holds.attrs["words"] = True
    yield "Table 1: scenes", "", [("", table1(results))]
    yield "Table 2: lossless compression, bytes (ratio)", "", [("", table2(results)), ("What each size contains", holds), "ratios"]
    if results.levels:
        yield ("Table 2 on real levels: ratio", "A star marks the smallest of what the paper compares. The paper has no such data.",
               [("", table2_levels(results)), "levels"])
    yield "Bytes against average visibility", "", ["bytes_against_visibility"]


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "zach2003", "Compressed visibility: Zach and Karner 2003, Tables 1 and 2", HOW_TO_READ, sections(results), charts,
                       records)


if __name__ == "__main__":
    tools.command_line(main)
