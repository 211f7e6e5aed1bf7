"""The tables of merging, clusters and subsets: as ./reproduce lossy wrote them, and as the report and the notebooks show them."""
import pathlib
from dataclasses import dataclass

import numpy
import pandas as pd

import report_tools as tools
from report_tools import name_of

SIDES = ("cells", "objects", "both")
TABLE_3_LOST = .05
FAR = 4 / 3  # a ratio further than this from the published one has to be explained


@dataclass
class Results:
    """The tables as the verbs of bench wrote them, None where one was not run; and the published figures."""
    curves: pd.DataFrame            # bench lossy-tables: a line for each merge and codec
    seeds: pd.DataFrame | None      # bench lossy-failures, this and the next five
    random: pd.DataFrame | None
    dense: pd.DataFrame | None
    cells: pd.DataFrame | None
    quantiles: pd.DataFrame | None
    trees: pd.DataFrame | None
    every_level: pd.DataFrame | None  # bench lossy-tables of all levels
    gotsman: pd.DataFrame | None    # bench gotsman-tables
    search: pd.DataFrame | None     # bench panne-search
    published: pd.DataFrame         # Table 3
    published_scenes: pd.DataFrame  # Table 1

    @property
    def matrices(self):
        return list(dict.fromkeys(self.curves.matrix))


def load(out):
    read = tools.tables_of(pathlib.Path(out) / "lossy")
    curves = read("curves")
    curves["total"] = curves.bytes + curves.names_bytes
    return Results(curves, *(read(f"failures_{name}") for name in ("seeds", "random", "dense", "cells", "quantiles", "trees")),
                   read("levels"), read("gotsman"), read("panne"), tools.published("zach2003_lossy"),
                   tools.published("zach2003_scenes").set_index("matrix"))


# ---- tables ----------------------------------------------------------------------------------------------------------------

def lossless(results, matrix):
    """The lines of a matrix as it is, by codec."""
    curves = results.curves
    return curves[(curves.matrix == matrix) & (curves.method == "none")].set_index("codec")


def table_3(results):
    """The paper's Table 3: the view cells that 5 % lost occlusions leave, and the bytes of its methods (with the ratio to the lossless
    table). As in the paper, the bytes include neither the map of cells nor their order. Ours are by both groupings, with
    Huffman codes, which the paper has, and with the range coder."""
    rows = []
    curves = results.curves[(results.curves.lost == TABLE_3_LOST) & (results.curves.side == "cells") & (results.curves.max_per_cell == 1)]
    published = results.published.set_index(["matrix", "codec"])
    for matrix in dict.fromkeys([*results.published.matrix, *results.matrices]):
        known = matrix in published.index
        whole = results.published_scenes.view_cells.get(matrix)
        if known:
            first = published.loc[matrix]
            rows.append({"scene": name_of(matrix), "": "published", "cells\nleft": f"{first.remaining_view_cells.iloc[0]:,}", "of": f"{whole:,.0f}",
                         "lossy table\nbytes": f"{first.bytes['lossy_table']:,}",
                         **{f"method {n}\nHuffman": f"{first.bytes[f'zach{n}']:,} ({first.ratio[f'zach{n}']:.1f}x)" for n in (3, 4)},
                         "average run\nmethod 3": f"{first.average_run['zach3']:.2f}", "average run\nmethod 4": f"{first.average_run['zach4']:.2f}"})
        of = curves[(curves.matrix == matrix) & (curves.nodes == 1)]
        if of.empty:
            continue
        table = lossless(results, matrix).table_bytes.iloc[0]
        for method, group in of.groupby("method", sort=False):
            by, one = group.set_index("codec"), group.iloc[0]
            row = {"scene": name_of(matrix), "": f"ours, {method}", "cells\nleft": f"{one.cells:,}", "of": f"{one.rows:,}",
                   "lossy table\nbytes": f"{one.table_bytes:,}"}
            for n in (3, 4):
                row[f"method {n}\nHuffman"] = f"{by.bytes[f'zach{n}-huffman']:,} ({table / by.bytes[f'zach{n}-huffman']:.1f}x)"
                row[f"method {n}\nrange coder"] = f"{by.bytes[f'zach{n}-range']:,} ({table / by.bytes[f'zach{n}-range']:.1f}x)"
                row[f"average run\nmethod {n}"] = f"{by.average_run[f'zach{n}-huffman']:.2f}"
                if known:
                    row[f"ratio, of published\nmethod {n}"] = f"{table / by.bytes[f'zach{n}-huffman'] / published.ratio[matrix, f'zach{n}']:.2f}"
            if known:
                share = table / by.bytes["zach3-huffman"] / published.ratio[matrix, "zach3"]
                row["within\na third"] = "yes" if 1 / FAR <= share <= FAR else "no"
            rows.append(row)
    columns = ["scene", "", "cells\nleft", "of", "lossy table\nbytes", "method 3\nHuffman", "ratio, of published\nmethod 3", "within\na third", "method 3\nrange coder",
               "method 4\nHuffman", "ratio, of published\nmethod 4", "method 4\nrange coder", "average run\nmethod 3", "average run\nmethod 4"]
    return pd.DataFrame(rows).reindex(columns=columns).fillna("")


def table_of_halves(results, lost=TABLE_3_LOST):
    """At that share of lost occlusions, every matrix: bytes with maps, and as a share of the same codec's lossless bytes."""
    rows = []
    curves = results.curves[(results.curves.lost == lost) & (results.curves.method == "pairs") & (results.curves.max_per_cell == 1)]
    for matrix in results.matrices:
        base, of = lossless(results, matrix).total, curves[curves.matrix == matrix]
        totals = of.pivot_table(index="codec", columns="side", values="total", sort=False).reindex(columns=list(SIDES))
        totals.loc["smallest of these"] = totals.min()
        for codec, sides in totals.iterrows():
            whole = base.min() if codec not in base.index else base[codec]
            row = {"matrix": name_of(matrix) if codec == totals.index[0] else "", "codec": codec, "lossless": f"{whole:,.0f}"}
            for side, value in sides.items():
                row[f"{side}\nmerged"] = "-" if pd.isna(value) else f"{value:,.0f}"
            for side, value in sides.items():
                row[f"of lossless\n{side}"] = "-" if pd.isna(value) else f"{value / whole:.0%}"
            row["at most\nhalf"] = "yes" if sides.min() <= whole / 2 else "no"
            rows.append(row)
    return pd.DataFrame(rows)


def table_of_every_level(results):
    """What 5 % lost occlusions leave of the bytes of a level's cells x cells, both sides merged, with maps; by how dense and how large
    the levels are. A dense level has few occlusions to lose, and the maps of a small one take half of the bytes."""
    levels = results.every_level
    whole = levels[levels.method == "none"].set_index("matrix")
    merged = levels[levels.method == "pairs"].set_index("matrix")
    visible, maps = whole.ones / whole.rows / whole["columns"], "names_bytes"
    share = (merged.bytes + merged[maps]) / (whole.bytes + whole[maps])
    payload = merged.bytes / whole.bytes
    bins = {"all": visible >= 0, "visible below 20 %": visible < .2, "20 to 40 %": visible.between(.2, .4, inclusive="left"), "40 % and more": visible >= .4,
            "view cells below 200": whole.rows < 200, "200 to 999": whole.rows.between(200, 999), "1,000 and more": whole.rows >= 1000}
    return pd.DataFrame({"levels": name, "number": f"{of.sum():,}", "at most half\nthe bytes": f"{(share[of] <= .5).sum():,}",
                         "median\nof lossless": f"{share[of].median():.0%}", "without\nmaps": f"{payload[of].median():.0%}"}
                        for name, of in bins.items() if of.any())


def table_at_extra(results, shares=(.01, .02, .05, .1, .2)):
    """For several shares of added entries: the bytes of the smallest codec, with maps, as a share of the smallest lossless ones.
    Between the points of a curve the logarithm of its bytes is interpolated."""
    rows = []
    curves = results.curves[(results.curves.method == "pairs") & (results.curves.max_per_cell == 1)]
    for (matrix, side), group in curves.groupby(["matrix", "side"], sort=False):
        base = lossless(results, matrix).total.min()
        points = group[group.lost > 0].groupby("lost").agg(total=("total", "min"), added=("added_share", "first"))
        x, y = [0, *points.added], numpy.log([base, *points.total])
        rows.append({"matrix": name_of(matrix), "merged": side} | {f"{share:.0%} extra\nvisible": f"{numpy.exp(numpy.interp(share, x, y)) / base:.0%}" if share <= x[-1] else "-"
                                                                              for share in shares})
    return pd.DataFrame(rows)


def table_of_loss(results):
    """The added entries of each merge and how they are spread over the cells: a line for each matrix, side and loss."""
    rows = []
    curves = results.curves[(results.curves.method != "none") & (results.curves.max_per_cell == 1)]
    for (matrix, method, side, lost), group in curves.groupby(["matrix", "method", "side", "lost"], sort=False):
        one, base = group.iloc[0], lossless(results, matrix).total
        least = group.loc[group.total.idxmin()]
        rows.append({"matrix": name_of(matrix), "method": method, "side": side, "lost\nat most": f"{lost:.1%}", "cells\nleft": f"{one.cells:,}", "objects\nleft": f"{one.objects:,}",
                     "added": f"{one.added:,}", "extra\nvisible": f"{one.added_share:.1%}", "median\nloss": f"{one.cell_median:.1%}", "95th\npercentile": f"{one.cell_95:.1%}",
                     "largest\nloss": f"{one.cell_worst:.1%}", "seconds\nto merge": f"{one.merge_s:.2f}", "bytes\nof maps": f"{one.names_bytes:,}", "smallest\ncodec": least.codec,
                     "bytes": f"{least.bytes:,}", "bytes with maps,\nof lossless": f"{least.total / base.min():.0%}"})
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
        rows.append({"matrix": name_of(matrix), "lost": f"{lost:.0%}", "cells left\nseeds": f"{seeds.cells:,}", "cells left\npairs": f"{pairs.cells:,}", "codec": codec,
                     "bytes\nseeds": f"{seeds.bytes:,}", "bytes\npairs": f"{pairs.bytes:,}", "pairs of\nseeds": f"{pairs.bytes / seeds.bytes:.3f}",
                     "seconds\nseeds": f"{seeds.merge_s:.2f}", "seconds\npairs": f"{pairs.merge_s:.2f}", "times\nas fast": f"{seeds.merge_s / max(pairs.merge_s, 1e-3):.1f}"})
    return pd.DataFrame(rows)


def table_of_seeds(results):
    rows = []
    for matrix, group in results.seeds.groupby("matrix", sort=False):
        pairs, seeds = group[group.method == "pairs"].iloc[0], group[group.method == "seeds"]
        rows.append({"matrix": name_of(matrix), "seeds": len(seeds), "cells left\nleast": f"{seeds.cells.min():,}", "median": f"{seeds.cells.median():,.0f}",
                     "most": f"{seeds.cells.max():,}", "bytes\nleast": f"{seeds.bytes.min():,}", "bytes\nmedian": f"{seeds.bytes.median():,.0f}", "bytes\nmost": f"{seeds.bytes.max():,}",
                     "spread": f"{seeds.bytes.max() / seeds.bytes.min() - 1:.1%}", "largest loss\nleast": f"{seeds.cell_worst.min():.0%}", "largest loss\nmost": f"{seeds.cell_worst.max():.0%}",
                     "pairs\ncells": f"{pairs.cells:,}", "pairs\nbytes": f"{pairs.bytes:,}"})
    return pd.DataFrame(rows)


def table_of_random(results):
    return pd.DataFrame([{"matrix": name_of(row.matrix), "rows": f"{row.rows:,}", "visible": f"{row.density:.1%}", "rows\nleft": f"{row.cells:,}", "rows left\nof all": f"{row.cells / row.rows:.0%}",
                          "lost": f"{row.lost_share:.1%}", "extra\nvisible": f"{row.added_share:.0%}", "lossless\nbytes": f"{row.bytes_before:,}", "bytes": f"{row.bytes:,}",
                          "of\nlossless": f"{row.bytes / row.bytes_before:.0%}", "largest\nloss": f"{row.cell_worst:.0%}"} for row in results.random.itertuples()])


def table_of_dense(results):
    return pd.DataFrame([{"matrix": row.matrix, "dense\nrows": row.dense, "ones\nin them": f"{row.share:.0%}" if row.dense else "", "method": row.method, "bound on\none cell": f"{row.max_per_cell:.0%}",
                          "lost\nat most": f"{row.lost:.0%}", "lost": f"{row.lost_share:.1%}", "rows\nleft": f"{row.cells:,}", "bytes": f"{row.bytes:,}", "others that lost\nmore than half": row.poisoned,
                          "median\nloss": f"{row.cell_median:.1%}", "95th\npercentile": f"{row.cell_95:.1%}", "largest\nloss": f"{row.cell_worst:.0%}"} for row in results.dense.itertuples()])


def table_of_cells(results):
    return pd.DataFrame([{"matrix": name_of(row.matrix), "bound on\none cell": f"{row.max_per_cell:.0%}", "cells\nleft": f"{row.cells:,}", "lost": f"{row.lost_share:.1%}", "median\nloss": f"{row.cell_median:.1%}",
                          "95th\npercentile": f"{row.cell_95:.1%}", "largest\nloss": f"{row.cell_worst:.1%}", "bytes": f"{row.bytes:,}", "bytes\nof maps": f"{row.names_bytes:,}"}
                         for row in results.cells.itertuples()])


def table_of_trees(results):
    return pd.DataFrame([{"matrix": name_of(row.matrix), "merged": row.way, "lost\nat most": f"{row.lost:.0%}", "columns\nleft": f"{row.columns_left:,}", "cells\nleft": f"{row.cells_left:,}",
                          "entries\nadded": f"{row.added:,}", "extra\nvisible": f"{row.added_share:.1%}", "nodes seen without\ntheir parent": f"{row.violations:,}",
                          "cells with\nsuch nodes": f"{row.cells_with_violations:,}"} for row in results.trees.itertuples()])


TREES = {"k-d": "by boxes", "by sets": "by sets"}  # as in the tables of bench: as `vismat tree --by` names them


def table_of_subsets(results):
    """Gotsman's methods over trees of view cells, and codecs without a tree. Bytes are the payload, with the model and without index and tree."""
    rows = []
    for (matrix, order), group in results.gotsman.groupby(["matrix", "order"], sort=False):
        for row in group.itertuples():
            third = group[(group.tree == row.tree) & (group.codec == "gotsman3")] if isinstance(row.tree, str) else group.head(0)
            rows.append({"matrix": matrix, "columns": order, "tree": TREES[row.tree] if isinstance(row.tree, str) else "-", "codec": row.codec, "bytes": f"{row.payload_bytes:,}",
                         "of the third\nmethod": f"{row.payload_bytes / third.payload_bytes.iloc[0]:.0%}" if len(third) else "", "bytes of\nthe model": f"{row.model_bytes:,}", "bytes of\nthe index": f"{row.index_bytes:,}",
                         "bytes of\nthe tree": f"{row.tree_bytes:,}", "ms to\nencode": f"{1e3 * row.encode_s:,.1f}", "ms to\ndecode": f"{1e3 * row.decode_s:,.1f}",
                         **({"us for a row,\nmedian": "", "us, 95th\npercentile": "", "us,\npath kept": "", "bytes read\nfor a row": ""} if pd.isna(row.row_us) else
                            {"us for a row,\nmedian": f"{row.row_us:.2f}", "us, 95th\npercentile": f"{row.row_us_95:.2f}", "us,\npath kept": f"{row.row_path_us:.2f}", "bytes read\nfor a row": f"{row.row_bytes_read:,.0f}"})})
    return pd.DataFrame(rows)


def table_of_search(results):
    """First and last state of each search for clusters."""
    rows = []
    for matrix, group in results.search.groupby("matrix", sort=False):
        first, last = group.iloc[0], group.iloc[-1]
        tenth = group[group.bytes <= last.bytes + .1 * (first.bytes - last.bytes)].iloc[0]
        rows.append({"matrix": matrix, "rows": f"{first.rows:,}", "columns": f"{first['columns']:,}", "without\nclusters": f"{first.bytes:,.0f}", "at the end": f"{last.bytes:,.0f}",
                     "of the\nfirst": f"{last.bytes / first.bytes:.0%}", "clusters": f"{last.clusters:,.0f}", "seconds": f"{last.seconds:.1f}", "seconds to nine\ntenths of the gain": f"{tenth.seconds:.1f}"})
    return pd.DataFrame(rows)
