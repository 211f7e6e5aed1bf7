"""The report on walks: what run-time systems read and draw, and how long frames stall; Chhugani et al. 2005, sections 7 and 8.

    bench/reproduce/walks_report.py [OUT [RECORDS]]   reads the tables that ./reproduce walks wrote to OUT/walks, writes report.html,
                                                      walks.txt and the charts beside them, prints the text, and keeps text and
                                                      tables in RECORDS

Nothing here measures: every figure is read, or a sum or quotient of what is read.
"""
import pathlib
from dataclasses import dataclass

import matplotlib.pyplot as plt
import pandas as pd

import report_tools as tools
from report_tools import BLUE, GREEN, GREY, ORANGE, RED, bare, legend_below, panels

LOOKS = {"everything": GREY, "frustum": RED, "frustum-levels": ORANGE, "cell-lists": GREEN, "vlod": BLUE}
STALLED = "stalled_frames_after_the_first_cell"


@dataclass
class Results:
    """The tables of ./reproduce walks, and the published figures."""
    walks: pd.DataFrame  # a line for each walk
    along: pd.DataFrame  # triangles of each frame of the first path
    bake: pd.DataFrame   # a line for each part of a bake
    published: pd.Series


def load(out):
    read = tools.tables_of(pathlib.Path(out) / "walks")
    return Results(*map(read, ("walks", "along", "bake")), tools.published("vlod2005_walks").set_index("figure"))


# ---- tables ----------------------------------------------------------------------------------------------------------------

def table_of_systems(results, scene):
    """All systems on all paths, under the disk of 2004 with prefetching."""
    of = results.walks[(results.walks.scene == scene) & (results.walks.varied == "system")]
    return pd.DataFrame([{
        "path": row.path, "system": row.system, "triangles\na frame": f"{row.mean_triangles:,.0f}", "objects\na frame": f"{row.mean_objects:,.0f}",
        "boundaries\ncrossed": row.crossings, "MB read": f"{row.bytes / 1e6:.1f}", "reads": f"{row.reads:,}",
        "cache,\nMB": f"{row.most_cached_bytes / 1e6:.1f}", "stalled\nframes": getattr(row, STALLED), "stall, ms,\nworst": f"{row.worst_stall_ms:.0f}",
        "frame, ms,\nmean": f"{row.mean_frame_ms:.2f}", "variance": f"{row.frame_ms_variance:.1f}",
        "wrong pixels": row.missing_pixels + row.wrong_pixels + row.extra_pixels, "images": row.images} for row in of.itertuples()])


def table_of_disks(results, scene):
    """Stalled frames after the first cell, with and without prefetching."""
    of = results.walks[(results.walks.scene == scene) & (results.walks.varied == "disk")]
    rows = []
    for (disk, system), pair in of.groupby(["disk", "system"], sort=False):
        without, with_it = pair[pair.prefetch_depth == 0].iloc[0], pair[pair.prefetch_depth == 1].iloc[0]
        rows.append({"disk": disk, "system": system, "boundaries\na second": f"{with_it.crossings / with_it.seconds:.2f}",
                     "stalled frames,\nno prefetch": without[STALLED], "stalled frames,\nprefetch": with_it[STALLED],
                     "stall, ms,\nno prefetch": f"{without.stall_ms:.1f}", "stall, ms,\nprefetch": f"{with_it.stall_ms:.1f}",
                     "worst, ms,\nno prefetch": f"{without.worst_stall_ms:.1f}", "worst, ms,\nprefetch": f"{with_it.worst_stall_ms:.1f}"})
    return pd.DataFrame(rows)


def table_of_ratios(results):
    """The published ratios beside ours; times of drawing, stalls apart."""
    rows = []
    of = results.walks[(results.walks.varied == "system") & (results.walks.path == "walk")]
    for scene, walks in of.groupby("scene", sort=False):
        triangles = walks.set_index("system").mean_triangles
        everything, frustum, levels, vlod = (triangles[s] for s in ("everything", "frustum", "frustum-levels", "vlod"))
        rows.append({"scene": tools.name_of(scene), "everything /\nfrustum + levels": f"{everything / levels:.2f}",
                     "frustum + levels /\nvLOD": f"{levels / vlod:.2f}", "frustum to vLOD:\nshare of levels": f"{(frustum - levels) / max(1, frustum - vlod):.0%}"})
    words = results.published.published
    rows.append({"scene": "power plant, published", "everything /\nfrustum + levels": f"about {words.everything_over_levels:g}",
                 "frustum + levels /\nvLOD": f"nearly {words.levels_over_vlod:g}", "frustum to vLOD:\nshare of levels": f"about {words.share_of_levels:.0%}"})
    return pd.DataFrame(rows)


def table_of_bakes(results):
    return pd.DataFrame([{"scene": row.scene, "part": row.part, "seconds": f"{row.seconds:.1f}",
                          "bytes": "" if pd.isna(row.bytes) else f"{row.bytes:,.0f}"} for row in results.bake.itertuples()])


# ---- charts ----------------------------------------------------------------------------------------------------------------

def along_the_path(results):
    scenes = list(results.along.scene.unique())
    figure, axes = panels(len(scenes), 1, 9, 2.8)
    for ax, scene in zip(axes, scenes):
        for system, color in LOOKS.items():
            of = results.along[(results.along.scene == scene) & (results.along.system == system)]
            if len(of):
                ax.plot(of.t, of.triangles.clip(lower=1), color=color, linewidth=1, label=system)
        ax.set_yscale("log")
        ax.set_title(tools.name_of(scene), loc="left")
        ax.set_xlabel("time on the path, s")
        ax.set_ylabel("triangles drawn a frame")
        bare(ax)
    legend_below(figure, axes[0].get_legend_handles_labels()[0], 4)
    return figure


def varied(results, what, label):
    scenes = list(results.walks[results.walks.varied == what].scene.unique())
    figure, axes = panels(len(scenes), 3, 3.6, 3)
    for ax, scene in zip(axes, scenes):
        of = results.walks[(results.walks.scene == scene) & (results.walks.varied == what)].copy()
        of["value"] = of.value.astype(float)
        for depth, color, name in ((0, RED, "no prefetching"), (1, BLUE, "neighbours prefetched")):
            line = of[of.prefetch_depth == depth].sort_values("value")
            ax.plot(line.value, 100 * line[STALLED] / line.frames, color=color, marker="o", markersize=4, label=name)
        ax.set_xscale("log", base=2)
        ax.xaxis.set_major_formatter(plt.FuncFormatter(lambda value, _: f"{value:g}"))
        ax.set_ylim(bottom=0)
        ax.set_title(tools.name_of(scene), loc="left")
        ax.set_xlabel(label)
        ax.set_ylabel("stalled frames, %")
        bare(ax)
    legend_below(figure, axes[0].get_legend_handles_labels()[0], 2)
    return figure


CHARTS = {
    "walks_along": ("Triangles that are drawn in each frame along the path; compare Fig. 8 of Chhugani et al. 2005.", along_the_path, ["along"]),
    "walks_cache": ("vLOD under the disk of 2004: the share of frames that stall, after the first cell, against the cache's budget.",
                    lambda results: varied(results, "cache", "cache, kB"), []),
    "walks_speed": ("vLOD under the disk of 2004: the share of frames that stall, after the first cell, against the viewer's speed.",
                    lambda results: varied(results, "speed", "speed, m/s"), []),
}

HOW_TO_READ = """A camera path is replayed under each run-time system on a virtual clock and disk: <b>everything</b> draws all objects in full detail,
<b>frustum</b> those that the frustum meets, <b>frustum-levels</b> the same at levels of detail that deviate by less than a pixel from anywhere in the
viewer's cell, <b>cell-lists</b> and <b>vlod</b> what is visible from the cell at these levels, by whole rows and by differences between neighbouring
cells. Frames wait for their data; a frame that waits is <b>stalled</b>. The first cell is loaded whole, and its frames do not count as stalled.
Wrong pixels are those that differ from an image of all objects at the same levels. The disk is that of 2004 (9 ms, 40 MB/s) where no other is named, the
cache 512 MB, and 3.5 million triangles are drawn a second, as in 2005."""


def sections(results):
    """As report_tools.as_text wants them."""
    yield "The published ratios", "Triangles a frame; the published figures are times of a frame of another scene.", [("", table_of_ratios(results))]
    yield "Along the path", "", ["walks_along"]
    scenes = list(results.walks.scene.unique())
    yield "Systems", "", [(tools.name_of(scene), table_of_systems(results, scene)) for scene in scenes]
    yield "Disks", "", [(tools.name_of(scene), table_of_disks(results, scene)) for scene in scenes]
    yield "Stalls against the cache and the speed", "", ["walks_cache", "walks_speed"]
    yield "Bakes", "", [("", table_of_bakes(results))]


def main(out="out", records=None):
    results = load(out)
    charts = tools.drawn(CHARTS, results)
    tools.write_report(out, "walks", "Walks", HOW_TO_READ, sections(results), charts, records)


if __name__ == "__main__":
    tools.command_line(main)
