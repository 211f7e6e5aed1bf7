"""What the reports share: names and colours, reading tables, tables as text and HTML, charts, the page, and where it was measured."""
import base64
import html
import pathlib
import subprocess
import sys

import matplotlib.pyplot as plt
import matplotlib.ticker
import pandas as pd

ROOT = pathlib.Path(__file__).resolve().parents[2]
PUBLISHED = ROOT / "bench" / "published"

BLUE, RED, GREY, GREEN, ORANGE, PURPLE = "#1f4e79", "#b03a2e", "#777777", "#558b2f", "#ef6c00", "#7e57c2"
LIGHT_BLUE, LIGHT_GREY, LIGHT_ORANGE, SKY, TEAL = "#8fb3d9", "#d0d0d0", "#ffcc80", "#42a5f5", "#26a69a"
OURS = dict(facecolor=BLUE, edgecolor=BLUE)
THEIRS = dict(facecolor="white", edgecolor="#333333", hatch="////", linewidth=0.8)

# Matrices and scenes whose names in the tables are not those that a reader should see.
NAMES = {"artificial-1": "artificial 1", "artificial-2": "artificial 2", "inner-city": "inner city", "power-plant": "power plant"}


def name_of(matrix):
    return NAMES.get(matrix, matrix)


def tables_of(folder):
    """A function that reads the table NAME.csv of the folder; it gives None where that was not measured."""
    def read(name):
        path = pathlib.Path(folder) / f"{name}.csv"
        return pd.read_csv(path, comment="#") if path.exists() else None

    return read


def published(name):
    return pd.read_csv(PUBLISHED / f"{name}.csv", comment="#")


def to_text(table):
    """Aligned columns, the first to the left and the others to the right; a column's name may have several lines."""
    names = [str(column).split("\n") for column in table.columns]
    height = max(map(len, names))
    head = [list(line) for line in zip(*([""] * (height - len(name)) + name for name in names))]
    body = [list(map(str, row)) for row in table.itertuples(index=False)]
    widths = [max(map(len, column)) for column in zip(*head, *body)]
    lines = ["  ".join(cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths))).rstrip()
             for row in [*head, ["-" * w for w in widths], *body]]
    return "\n".join(lines)


def to_html(table):
    """A table whose attrs["words"] is set is aligned to the left."""
    def cells(tag, row, classes):
        return "".join(f'<{tag}{c}>{html.escape(str(cell))}</{tag}>' for cell, c in zip(row, classes))

    mark = ' class="published"'
    classes = [mark if str(column).endswith("published") else "" for column in table.columns]
    body = "".join(f"<tr{mark if 'published' in map(str, row) else ''}>{cells('td', row, classes)}</tr>\n"
                   for row in table.itertuples(index=False))
    words = ' class="words"' if table.attrs.get("words") else ""
    return f'<div class="wide"><table{words}><thead><tr>{cells("th", table.columns, classes)}</tr></thead>\n<tbody>{body}</tbody></table></div>'


# ---- charts ----------------------------------------------------------------------------------------------------------------

def bare(axes):
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_axisbelow(True)


def panels(count, columns, width, height, grid=True, **more):
    """A figure with `count` axes in rows of at most `columns`, each of width and height in inches; and the axes."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(width * columns, height * rows), squeeze=False, layout="constrained", **more)
    axes = list(axes.flat)
    for spare in axes[count:]:
        spare.set_axis_off()
    for a in axes[:count]:
        bare(a)
        if grid:
            a.grid(which="major", color="#e6e6e6")
    return figure, axes[:count]


def legend_below(figure, handles, columns, **more):
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(.5, -.01), ncols=columns, frameon=False, **more)


def plain_ticks(axis, unit, steps=(1, 2, 5)):
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=steps))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}{unit}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def drawable(charts, results):
    """Of `charts`, name to caption, function and the tables that it needs: those whose tables are there."""
    return {name: (caption, draw) for name, (caption, draw, needs) in charts.items()
            if all(getattr(results, need) is not None and len(getattr(results, need)) for need in needs)}


def drawn(charts, results):
    """These charts' names to caption and figure."""
    return {name: (caption, draw(results)) for name, (caption, draw) in drawable(charts, results).items()}


# ---- the page --------------------------------------------------------------------------------------------------------------

def provenance(folder):
    """Machine, compiler and commit, and when the tables in the folder were measured, as lines."""
    def first_line(*command):
        try:
            return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()[0]
        except (OSError, subprocess.CalledProcessError, IndexError):
            return "unknown"

    def line_of(path, key):
        try:
            return next((line for line in path.read_text().splitlines() if line.startswith(key)), "")
        except OSError:
            return ""

    cpu = line_of(pathlib.Path("/proc/cpuinfo"), "model name").partition(":")[2].strip() or "unknown"
    memory = line_of(pathlib.Path("/proc/meminfo"), "MemTotal").split()
    compiler = line_of(ROOT / "build/release/CMakeCache.txt", "CMAKE_CXX_COMPILER:").partition("=")[2] or "c++"
    lines = [f"machine: {cpu}, {first_line('nproc')} cores" + (f", {int(memory[1]) / 2**20:.0f} GB" if len(memory) > 1 else ""),
             f"compiler: {first_line(compiler, '--version')}, CMake preset release",
             f"commit: {first_line('git', 'describe', '--always', '--dirty')} of {first_line('git', 'log', '-1', '--format=%cs')}"]
    steps = tables_of(folder)("steps")
    if steps is not None and "date" in steps and len(steps):
        other = (steps.other_work_percent * steps.minutes).sum() / max(steps.minutes.sum(), 1e-9)
        days = " to ".join(dict.fromkeys((steps.date.min(), steps.date.max())))
        lines.append(f"measured: {days}, {steps.minutes.sum():.0f} minutes; other work took {other:.0f} % of the processors meanwhile")
    return lines


STYLE = """body{max-width:74rem;margin:2rem auto;padding:0 1.5rem;background:#fff;color:#1a1a1a;font:16px/1.55 Georgia,serif}
h1,h2,h3,table,figcaption,footer{font-family:system-ui,"DejaVu Sans",sans-serif}h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:2.2rem}h3{font-size:.95rem}
p{max-width:46rem}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.8rem;font-variant-numeric:tabular-nums}
th{border-bottom:2px solid #444;text-align:right;vertical-align:bottom}td{border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}
th,td{padding:.28rem .55rem}th:first-child,td:first-child{text-align:left}.words td,.words th{text-align:left}td.published,th.published{background:#f2f2f2;font-style:italic}
tr.published td{background:#f2f2f2;font-style:italic}figure{margin:1rem 0}img{max-width:100%}footer{margin-top:2.5rem;font-size:.8rem;color:#444}"""


def figure(caption, png):
    return (f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
            f"<figcaption>{html.escape(caption)}</figcaption></figure>\n")


def page(title, body, lines):
    """One HTML page that needs no other file; `lines` stand at its foot."""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style></head><body>
{body}<footer>{"<br>".join(map(html.escape, lines))}</footer>
</body></html>
"""


def as_text(sections):
    """Headings, words and tables of `sections`: triples of a heading, words, and items, each a chart's name or a pair of a label
    and a table."""
    parts = []
    for heading, words, items in sections:
        parts += ["", heading, "=" * len(heading), *([words] if words else [])]
        for item in items:
            if not isinstance(item, str):
                label, table = item
                parts += ["", *([label] if label else []), to_text(table)]
    return "\n".join(parts[1:])


def not_measured(folder):
    """A section that names what a run left out, if it left out anything."""
    path = pathlib.Path(folder) / "not_measured.txt"
    return [("Not measured", "; ".join(path.read_text().splitlines()) + ".", [])] if path.exists() else []


def write_report(out, name, title, introduction, sections, charts, records=None):
    """Writes report.html, NAME.txt and a PNG for each chart to OUT/NAME; prints the text. `charts`: name to caption and figure.
    With `records`: copies of the tables and the text there, with machine, compiler, commit and date as comments before them."""
    folder = pathlib.Path(out) / name
    sections, lines = [*not_measured(folder), *sections], provenance(folder)
    images = {}
    for chart, (caption, drawn) in charts.items():
        drawn.savefig(folder / f"{chart}.png", dpi=120, bbox_inches="tight")
        plt.close(drawn)
        images[chart] = figure(caption, (folder / f"{chart}.png").read_bytes())
    body = f"<h1>{html.escape(title)}</h1>\n<p>{introduction}</p>\n"
    for heading, words, items in sections:
        body += f"<h2>{html.escape(heading)}</h2>\n" + (f"<p>{html.escape(words)}</p>\n" if words else "")
        for item in items:
            body += images[item] if isinstance(item, str) else (f"<h3>{html.escape(item[0])}</h3>" if item[0] else "") + to_html(item[1]) + "\n"
    (folder / "report.html").write_text(page(f"vismat: {title}", body, lines))
    (folder / f"{name}.txt").write_text("\n".join([as_text(sections), "", *lines, ""]))
    if records:
        records = pathlib.Path(records)
        records.mkdir(parents=True, exist_ok=True)
        origin = "".join(f"# {line}\n" for line in lines)
        for path in [*folder.glob("*.csv"), *folder.glob("*.txt")]:
            (records / path.name).write_text(origin + path.read_text())
    print(as_text(sections))


def command_line(main):
    """Runs a report's main(OUT, RECORDS) with the words of the command line."""
    plt.switch_backend("agg")
    main(*sys.argv[1:])
