"""The tables and charts of the study of rows-small and rows-quick: what each part buys, where the bits are, wrong orders and wrong entries.

Read from what bench row-study and bench train-rows wrote; every figure is one of theirs or a quotient of two.
"""
import matplotlib.pyplot as plt
import numpy
import pandas as pd

from report_tools import BLUE, GREEN, GREY, LIGHT_BLUE, LIGHT_GREY, LIGHT_ORANGE, ORANGE, PURPLE, RED, SKY, TEAL, legend_below, panels, plain_ticks

# What the parts are, as a reader should see them.
PARTS = {
    "second reference": "a second reference", "named second references": "the choice of a second reference", "common runs": "runs listed once",
    "groups": "groups of rows in one stream", "kept rows": "rows kept decoded", "references": "any reference at all",
    "order of rows by references": "rows in the tree's order", "duplicates once": "equal rows and columns once", "limit of time": "the limit on decoding time",
    "shape": "contexts: values and changes around", "recent": "contexts: last outcomes", "left": "contexts: how many changes are left",
}
ORDERS = {"natural": (GREY, "natural"), "random": (RED, "random"), "of half the rows": (SKY, "best of every second row"), "of another matrix": (ORANGE, "best of another matrix of the level")}
KIND_COLOURS = (BLUE, LIGHT_BLUE, SKY, ORANGE, LIGHT_ORANGE, PURPLE, GREY, LIGHT_GREY)
CODEC_COLOURS = {"rows-small": BLUE, "rows-quick": SKY, "rows-fast-ids": TEAL, "rows-fast-bits": GREEN, "bv": RED, "pair-huffman-shared": PURPLE, "quake-rle": GREY, "roaring": "#333333", "xz": ORANGE}
MARKS = "osD^vPX*"
TIERS = ("rows-small", "rows-quick")


def more_without(results):
    """How much more bytes each codec takes without a part, as shares; a line for each codec and part, a column for each matrix."""
    ablation = results.ablation.pivot_table(index=["codec", "without"], columns="matrix", values="bytes", sort=False)
    parts = [ablation.loc[codec].drop(index="nothing") / ablation.loc[(codec, "nothing")] - 1 for codec in TIERS]
    if results.training is not None:
        for i, column in enumerate(("small", "quick")):
            trained = results.training.pivot_table(index="without", columns="matrix", values=column, sort=False)
            parts[i] = pd.concat([parts[i], trained.drop(index="nothing") / trained.loc["nothing"] - 1])
    table = pd.concat(dict(zip(TIERS, parts)))
    return table[list(dict.fromkeys(results.ablation.matrix))]


def table_of_parts(results):
    table = more_without(results)
    return pd.DataFrame([{"codec": codec, "without": PARTS[part], **{matrix: "-" if pd.isna(value) else f"{value:+.1%}" for matrix, value in table.loc[codec, part].items()}} for codec, part in table.index])


def shares_of_bits(results, codec):
    bits = results.bits[results.bits.codec == codec].pivot_table(index="matrix", columns="kind", values="bytes", sort=False)
    return bits.div(bits.sum(axis=1), axis=0), bits.sum(axis=1)


def table_of_bits(results):
    rows = []
    for codec in TIERS:
        shares, bytes_in_all = shares_of_bits(results, codec)
        rows += [{"matrix": matrix, "codec": codec, "bytes": f"{bytes_in_all[matrix]:,.0f}", **{kind.replace(" ", "\n", 1): f"{share:.1%}" for kind, share in line.items()}} for matrix, line in shares.iterrows()]
    return pd.DataFrame(rows)


def of_best(results):
    """The table of wrong orders and entries, with the bytes as multiples of those in the best order without flipped entries."""
    table = results.sensitivity
    base = table[(table.order == "best") & (table.flipped == 0)].set_index(["matrix", "codec"]).bytes
    return table.assign(ratio=table.bytes / pd.MultiIndex.from_frame(table[["matrix", "codec"]]).map(base))


def table_of_orders(results):
    table = of_best(results)
    table = table[table.flipped == 0].pivot_table(index=["matrix", "codec"], columns="order", values="ratio", sort=False)
    kept = [order for order in ORDERS if order in table]
    return pd.DataFrame([{"matrix": matrix, "codec": codec, **{ORDERS[order][1].replace(" of ", "\nof "): "-" if pd.isna(line[order]) else f"{line[order]:.2f}" for order in kept}}
                         for (matrix, codec), line in table.iterrows()])


def table_of_noise(results):
    table = of_best(results)
    table = table[table.flipped > 0].pivot_table(index=["matrix", "codec"], columns=["flipped", "order"], values="ratio", sort=False)
    return pd.DataFrame([{"matrix": matrix, "codec": codec, **{f"{share:.1%} flipped\norder {'made after' if order == 'best' else 'of before'}": f"{value:.2f}" for (share, order), value in line.items()}}
                         for (matrix, codec), line in table.iterrows()])


# ---- charts ----------------------------------------------------------------------------------------------------------------

def draw_parts(results):
    """Bytes more without each part; a panel for each codec, a mark for each matrix."""
    table = 100 * more_without(results)
    figure, all_axes = panels(len(TIERS), 2, 7, 4.6)
    for axes, codec in zip(all_axes, TIERS):
        parts = [part for part in PARTS if part in table.loc[codec].index]
        for i, matrix in enumerate(table.columns):
            values = table.loc[codec].reindex(parts)[matrix]
            axes.plot(values, range(len(parts)), marker=MARKS[i % len(MARKS)], markersize=6, linestyle="", color=(BLUE, ORANGE, TEAL, PURPLE, RED, GREY)[i % 6], label=matrix)
        axes.axvline(0, color="black", linewidth=.8)
        axes.set_xscale("symlog", linthresh=10, linscale=1.5)
        axes.set_xlim(min(-2, 1.3 * numpy.nanmin(table)), 1.5 * numpy.nanmax(table))
        axes.set(yticks=range(len(parts)), yticklabels=[PARTS[part] for part in parts], xlabel="bytes more without it, %")
        axes.invert_yaxis()
        axes.xaxis.set_major_locator(plt.FixedLocator([-10, -5, 0, 5, 10, 20, 50, 100, 200]))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_locator(plt.NullLocator())
        axes.set_title(codec, fontsize=10, loc="left")
    legend_below(figure, all_axes[0].get_legend_handles_labels()[0], 6, fontsize=8)
    return figure


def draw_bits(results):
    """What the bytes of rows-small and rows-quick are spent on; a bar for each matrix."""
    figure, all_axes = panels(len(TIERS), 2, 7, 3, grid=False)
    for axes, codec in zip(all_axes, TIERS):
        shares, bytes_in_all = shares_of_bits(results, codec)
        left = numpy.zeros(len(shares))
        for kind, colour in zip(shares.columns, KIND_COLOURS):
            axes.barh(range(len(shares)), 100 * shares[kind], left=left, color=colour, height=.7, label=kind)
            for y, (start, share) in enumerate(zip(left, 100 * shares[kind])):
                if share >= 5:
                    axes.text(start + share / 2, y, f"{share:.0f}", ha="center", va="center", fontsize=8, color="white" if colour in (BLUE, PURPLE, GREY) else "black")
            left += 100 * shares[kind].to_numpy()
        axes.set(yticks=range(len(shares)), yticklabels=[f"{matrix}\n{bytes_in_all[matrix]:,.0f} bytes" for matrix in shares.index], xlabel="% of the bytes", xlim=(0, 100))
        axes.invert_yaxis()
        axes.set_title(codec, fontsize=10, loc="left")
    legend_below(figure, all_axes[0].get_legend_handles_labels()[0], 4, fontsize=8)
    return figure


def draw_orders(results):
    """Bytes in wrong orders, in multiples of those in the best order; a panel for each matrix."""
    table = of_best(results)
    table = table[(table.flipped == 0) & table.order.isin(ORDERS)]
    matrices = list(dict.fromkeys(table.matrix))
    figure, all_axes = panels(len(matrices), 3, 4.8, 3.4)
    codecs = list(dict.fromkeys(table.codec))
    for axes, matrix in zip(all_axes, matrices):
        for order, (colour, _) in ORDERS.items():
            of = table[(table.matrix == matrix) & (table.order == order)].set_index("codec").ratio.reindex(codecs)
            axes.plot(of, range(len(codecs)), marker="o", markersize=6, linestyle="", color=colour)
        axes.axvline(1, color="black", linewidth=.8)
        axes.set(xscale="log", yticks=range(len(codecs)), yticklabels=codecs, xlabel="bytes, times those in the best order")
        axes.invert_yaxis()
        plain_ticks(axes.xaxis, "", (1, 2, 5))
        axes.set_title(matrix, fontsize=10, loc="left")
    legend_below(figure, [plt.Line2D([], [], color=colour, marker="o", linestyle="", label=label) for order, (colour, label) in ORDERS.items() if order in set(table.order)], 4, fontsize=8)
    return figure


def draw_noise(results):
    """Bytes against the share of flipped entries; a panel for each matrix, a line for each codec."""
    table = results.sensitivity[results.sensitivity.order.isin(("best", "before"))]
    matrices = list(dict.fromkeys(table.matrix))
    figure, all_axes = panels(len(matrices), 3, 4.8, 3.6)
    for axes, matrix in zip(all_axes, matrices):
        for codec, colour in CODEC_COLOURS.items():
            of = table[(table.matrix == matrix) & (table.codec == codec)]
            clean = of[of.flipped == 0]
            for order, line in (("best", "-"), ("before", ":")):
                points = pd.concat([clean, of[(of.order == order) & (of.flipped > 0)]])
                axes.plot(100 * points.flipped, points.bytes / 1e3, color=colour, linestyle=line, linewidth=1.4, marker="o", markersize=3)
        axes.set_xscale("symlog", linthresh=.1, linscale=.5)
        axes.set(yscale="log", xlabel="entries flipped, %", ylabel="kB", xticks=[0, .1, 1, 5])
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_locator(plt.NullLocator())
        plain_ticks(axes.yaxis, "", (1, 2, 5))
        axes.set_title(matrix, fontsize=10, loc="left")
    handles = [plt.Line2D([], [], color=colour, linewidth=2, label=codec) for codec, colour in CODEC_COLOURS.items() if codec in set(table.codec)]
    handles += [plt.Line2D([], [], color=GREY, label="order made after the flips"), plt.Line2D([], [], color=GREY, linestyle=":", label="order of before")]
    legend_below(figure, handles, 6, fontsize=8)
    return figure


CHARTS = {"rows_parts": ("How many bytes more rows-small and rows-quick take without each part of the method", draw_parts, ["ablation"]),
          "rows_bits": ("What the bytes of rows-small and rows-quick are spent on", draw_bits, ["bits"]),
          "rows_orders": ("Bytes in wrong and stale orders of columns, in multiples of those in the best order", draw_orders, ["sensitivity"]),
          "rows_noise": ("Bytes against the share of flipped entries, in an order made after and before they were flipped", draw_noise, ["sensitivity"])}


def sections(results):
    """As report_tools.as_text wants them."""
    if results.ablation is not None:
        yield ("What each part buys", "Contexts were left out in training; the other parts are switched off under the shipped weights, which favours the whole a little.",
               ["rows_parts", ("Bytes more without it", table_of_parts(results))])
    if results.bits is not None:
        yield "Where the bits are", "", ["rows_bits", ("Shares of the bytes", table_of_bits(results))]
    if results.sensitivity is not None:
        yield ("Wrong orders and wrong entries", "", ["rows_orders", ("Bytes, in multiples of those in the best order", table_of_orders(results)),
                                                      "rows_noise", ("Bytes with flipped entries, in multiples of those without", table_of_noise(results))])
