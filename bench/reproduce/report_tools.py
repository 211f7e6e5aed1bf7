"""What the reports share: tables as text and HTML, the look of charts, one page that needs no other file, where it was measured."""
import base64
import html
import pathlib
import subprocess

import matplotlib.pyplot
import matplotlib.ticker

ROOT = pathlib.Path(__file__).resolve().parent.parent
PUBLISHED = ROOT / "bench" / "published"

OURS = dict(facecolor="#1f4e79", edgecolor="#1f4e79")
THEIRS = dict(facecolor="white", edgecolor="#333333", hatch="////", linewidth=0.8)


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
    def cells(tag, row, classes):
        return "".join(f'<{tag}{c}>{html.escape(str(cell))}</{tag}>' for cell, c in zip(row, classes))

    mark = ' class="published"'
    classes = [mark if str(column).endswith("published") else "" for column in table.columns]
    body = "".join(f"<tr{mark if {'published', 'prototype'} & set(map(str, row)) else ''}>{cells('td', row, classes)}</tr>\n"
                   for row in table.itertuples(index=False))
    return f'<div class="wide"><table><thead><tr>{cells("th", table.columns, classes)}</tr></thead>\n<tbody>{body}</tbody></table></div>'


def bare(axes):
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_axisbelow(True)


def plain_ticks(axis, unit, steps=(1, 2, 5)):
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=steps))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}{unit}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def provenance():
    """Machine, compiler and commit, as lines."""
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
    return [f"machine: {cpu}, {first_line('nproc')} cores" + (f", {int(memory[1]) / 2**20:.0f} GB" if len(memory) > 1 else ""),
            f"compiler: {first_line(compiler, '--version')}, CMake preset release",
            f"commit: {first_line('git', 'describe', '--always', '--dirty')} of {first_line('git', 'log', '-1', '--format=%cs')}"]


STYLE = """body{max-width:74rem;margin:2rem auto;padding:0 1.5rem;background:#fff;color:#1a1a1a;font:16px/1.55 Georgia,serif}
h1,h2,table,figcaption,footer{font-family:system-ui,"DejaVu Sans",sans-serif}h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:2.2rem}
p{max-width:46rem}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.8rem;font-variant-numeric:tabular-nums}
th{border-bottom:2px solid #444;text-align:right;vertical-align:bottom}td{border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}
th,td{padding:.28rem .55rem}th:first-child,td:first-child{text-align:left}.words td{text-align:left}td.published,th.published{background:#f2f2f2;font-style:italic}
tr.published td{background:#f2f2f2;font-style:italic}figure{margin:1rem 0}img{max-width:100%}footer{margin-top:2.5rem;font-size:.8rem;color:#444}"""


def figure(caption, png):
    return (f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
            f"<figcaption>{html.escape(caption)}</figcaption></figure>\n")


def page(title, body):
    """One HTML page that needs no other file."""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style></head><body>
{body}<footer>{"<br>".join(map(html.escape, provenance()))}</footer>
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


def write_report(out, name, title, introduction, sections, charts, records=None):
    """Writes OUT/NAME.html, OUT/NAME/NAME.txt and a PNG a chart to OUT/NAME; prints the text. `charts`: name to caption and
    figure. With `records`: copies of the tables there, machine and commit as comments before them."""
    out, sections = pathlib.Path(out), list(sections)
    images = {}
    for chart, (caption, drawn) in charts.items():
        drawn.savefig(out / name / f"{chart}.png", dpi=120, bbox_inches="tight")
        matplotlib.pyplot.close(drawn)
        images[chart] = figure(caption, (out / name / f"{chart}.png").read_bytes())
    body = f"<h1>{html.escape(title)}</h1>\n<p>{introduction}</p>\n"
    for heading, words, items in sections:
        body += f"<h2>{html.escape(heading)}</h2>\n" + (f"<p>{html.escape(words)}</p>\n" if words else "")
        for item in items:
            body += images[item] if isinstance(item, str) else (f"<h3>{html.escape(item[0])}</h3>" if item[0] else "") + to_html(item[1]) + "\n"
    (out / f"{name}.html").write_text(page(f"vismat: {title}", body))
    (out / name / f"{name}.txt").write_text("\n".join([as_text(sections), "", *provenance(), ""]))
    if records:
        records = pathlib.Path(records)
        records.mkdir(parents=True, exist_ok=True)
        origin = "".join(f"# {line}\n" for line in provenance())
        for path in [*(out / name).glob("*.csv"), out / name / f"{name}.txt"]:
            (records / path.name).write_text(origin + path.read_text())
    print(as_text(sections))
