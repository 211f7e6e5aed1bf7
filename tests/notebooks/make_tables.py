"""Makes the small tables that the tests of notebooks and reports share, by every program that ./reproduce runs.

    make_tables.py VISMAT BENCH OUT

OUT gets the folders that ./reproduce makes in out/, a few small matrices, and in OUT/told what each command printed.
"""
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def walk():
    """Disk reads of a walk through a level. Levels are in no repository, so the table is written here."""
    lines = ["matrix,layout,page_bytes,read_ahead_pages,steps,reads,bytes_read,bytes_wanted"]
    for page in (4096, 65536):
        lines += [f"tiny,{layout},{page},1,100,{reads},{reads * page},400000" for layout, reads in (("identity", 500), ("random", 1000), ("best", 400))]
    return "\n".join(lines) + "\n"


def main(vismat, bench, out):
    out = pathlib.Path(out)
    shutil.rmtree(out, ignore_errors=True)
    folders = zach, layout, vlod, lossy, visibility, rows, walks = [
        out / name for name in ("zach2003", "layout", "vlod", "lossy", "visibility", "rows", "walks")]
    told, matrices, large, pictures = out / "told", out / "matrices", out / "matrices/large", visibility / "pictures"
    for folder in (*folders, told, matrices, large, pictures):
        folder.mkdir(parents=True)

    def run(name, *words):
        """Runs a command and keeps what it prints in OUT/told/NAME.txt."""
        ended = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if ended.returncode != 0:
            raise RuntimeError(f"{' '.join(ended.args)} ended with {ended.returncode}:\n{ended.stdout}{ended.stderr}")
        (told / f"{name}.txt").write_text(ended.stdout)

    def city(folder, name, size, seed, *more):
        scene = folder / f"{name}.scene.h5"
        run(f"city {size} {name}", vismat, "city", "--size", size, "--seed", seed, "-o", scene)
        run(f"see {size} {name}", vismat, "see", scene, "--producer", "climbing", *more, "-o", folder / f"{name}.bsp.h5")

    def both(jobs):
        """Runs jobs, as many at once as there are processors."""
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for job in [pool.submit(*job) for job in jobs]:
                job.result()

    city_1, city_2, differences = [matrices / f"{name}.bsp.h5" for name in ("artificial-1", "tiny.cells", "artificial-1.differences")]
    larger, objects = [large / f"{name}.bsp.h5" for name in ("artificial-1", "tiny.objects")]
    both([(city, matrices, "artificial-1", 4, 1), (city, matrices, "tiny.cells", 4, 2), (city, large, "artificial-1", 8, 1), (city, large, "tiny.objects", 8, 1, "--objects")])
    run("differences", vismat, "deltas", city_1, "-o", differences)

    def structure():
        run("structure", sys.executable, ROOT / "bench/reproduce/table_structure.py", city_1, city_2)
        shutil.copy(told / "structure.txt", zach / "zach2003_structure.csv")

    def of_rows():
        run("orders", bench, "orders", "--out", layout, city_1, city_2)
        run("orders of rows", bench, "orders", "--out", layout, "--append", "--side", "rows", city_1)

    def of_merging():
        curves = "lossy-tables", "--csv", lossy / "curves.csv"
        run("lossy", bench, *curves, "--lost", "0,.05,.2", "--codecs", "pair-ans,delimiter,panne,xz,jbig1", larger, objects)
        run("lossy by seeds", bench, *curves, "--append", "--no-lossless", "--methods", "seeds", "--sides", "cells", "--lost", ".05", larger, objects)

    def of_a_dense_city():
        scene = pictures / "city.scene.h5"
        run("dense city", vismat, "dense-city", "--size", 4, "-o", scene)
        for effort in (0, 1):
            name = pictures / f"city.effort{effort}"
            run(f"effort {effort}", vismat, "see", scene, "--cells", "grid:4,4,1.5", "--region", "36,36,1,44,44,2.5", "--effort", effort,
                "-o", f"{name}.bsp.h5", "--seen", f"{name}.seen.bsp.h5")

    def of_rows_alone():
        octants, cells = matrices / "tiny.octants.bsp.h5", matrices / "tiny.cells.bsp.h5"
        run("octants", bench, "octants", matrices / "tiny.cells.scene.h5", "--octants", 150, "--cells", "grid:20", "--rays", 20, "-o", octants)
        run("info octants", vismat, "info", octants)
        level = ROOT / "tests/data/fuzz/quake3_bsp/tiny"
        run("octants of a level", bench, "octants", level, "--octants", 20, "--view-cells", 30, "--rays", 20, "-o", out / "tiny_level.bsp.h5")
        run("rows, natural", vismat, "compare", "--seconds", 0, "--codecs", "zpaq", "--csv", rows / "natural.csv", octants, cells)
        run("row study", bench, "row-study", "--out", rows, "--flipped", ".01,.05", "--codecs", "rows-small,pair-huffman-shared,quake-rle", cells)
        lines = ["matrix,without,small,quick"]
        for idea in ("nothing", "shape"):
            run(f"trained without {idea}", bench, "train-rows", "--rounds", 1, *(("--without", idea) if idea != "nothing" else ()), cells)
            for line in (told / f"trained without {idea}.txt").read_text().splitlines()[1:]:
                name, *_, small, quick = line.split()
                lines.append(f"{name},{idea},{small},{quick}")
        (rows / "training.csv").write_text("\n".join(lines) + "\n")
        run("rows", vismat, "compare", "--seconds", 0, "--orders", "best", "--codecs", "pair-ans,quake-rle,roaring,xz", "--csv", rows / "best.csv", octants, cells)

    def of_walks():
        scene, baked, path, line = walks / "city.scene.h5", walks / "city.bake", walks / "city.path", ROOT / "bench/reproduce/walk_line.py"
        run("walks, city", vismat, "dense-city", "--size", 2, "--car-sides", 8, "-o", scene)
        run("walks, bake", vismat, "bake", scene, "--effort", 0, "-o", baked)
        run("walks, path", vismat, "path", scene, "--kind", "walk", "--seconds", 20, "--speed", 4, "-o", path)
        run("walks, header", sys.executable, line, "--header")
        lines, along = [(told / "walks, header.txt").read_text()], ["scene,system,t,triangles"]
        systems = "everything", "frustum", "frustum-levels", "cell-lists", "vlod"
        one = [("system", system, "--system", system, "--images", 20) for system in systems]
        one += [("disk", depth, "--disk", disk, "--prefetch", depth) for disk in ("disk-2004", "nvme") for depth in (0, 1)]
        one += [(what, value, *options, "--prefetch", depth) for what, value, *options in (("cache", 8, "--cache", "8M"), ("speed", 4)) for depth in (0, 1)]
        for what, value, *options in one:
            run("walks, walk", vismat, "walk", baked, path, "--frames", 60, "--width", 80, "--height", 60, "--summary", walks / "one.json",
                "--log", walks / "one.log", *options)
            run("walks, line", sys.executable, line, walks / "one.json", "scene=city", "path=walk", f"varied={what}", f"value={value}")
            lines.append((told / "walks, line.txt").read_text())
            if what == "system":
                log = [row.split(",") for row in (walks / "one.log").read_text().splitlines()]
                along += [f"city,{value},{row[1]},{row[log[0].index('drawn_triangles')]}" for row in log[1:]]
        (walks / "walks.csv").write_text("".join(lines))
        (walks / "along.csv").write_text("\n".join(along) + "\n")
        (walks / "bake.csv").write_text("scene,part,seconds,bytes\ncity,levels of detail,1.5,\ncity,geometry.store,.1,1000\n")

    (layout / "disk_walk.csv").write_text(walk())
    both([  # the longest first
        (run, "producers", bench, "visibility-tables", "--csv", visibility / "tables.csv", "--places", 1, "--cells", 1, "tilted-boxes"),
        (run, "compare", vismat, "compare", "--seconds", 0, "--orders", "natural,best", "--csv", vlod / "compare.csv", city_1, differences),
        (run, "lossy failures", bench, "lossy-failures", "--lost", .2, "--seeds", 2, "--size", 40, "--out", lossy, objects, larger),
        (of_merging,),
        (of_rows_alone,),
        (of_rows,),
        (of_walks,),
        (run, "order failures", bench, "order-failures", "--out", layout, "--scale", .001, "--columns", 40, "--seeds", 3, "--queries", 10, city_1),
        (of_a_dense_city,),
        (run, "codes", bench, "vlod-tables", "--seconds", 0, "--csv", vlod / "codes.csv", "--scale", .0005, "--", differences),
        (run, "zach2003", bench, "zach-tables", "--out", zach, city_1, city_2),
        (structure,),
        (run, "distances", bench, "distance-statistics", "--out", layout, "--trials", 5, "--scale", .001, city_1, city_2),
        *((run, f"scale {scale}", bench, "order-scale", "--scale", scale, "--csv", layout / f"scale_power-plant_{scale}.csv") for scale in (.0005, .001)),
        (run, "flann", bench, "flann-recall", "--rows", 256, "--density", .05, "--columns", 200, "--queries", 20, "--csv", layout / "flann_recall.csv"),
        (run, "compare distinct", vismat, "compare", "--seconds", 0, "--distinct", "--codecs", "gzip,delimiter", "--csv", vlod / "compare_distinct.csv", city_1),
        (run, "row failures", bench, "row-failures", "--seconds", 0, "--copies", 32, "--csv", vlod / "failures.csv"),
        (run, "walk", bench, "walk-deltas", "--steps", 300, "--csv", vlod / "walk.csv", city_1),
        (run, "subsets", bench, "gotsman-tables", "--seconds", 0, "--csv", lossy / "gotsman.csv", objects),
        (run, "clusters", bench, "panne-search", "--seconds", 0, "--csv", lossy / "panne.csv", objects)])


if __name__ == "__main__":
    main(*sys.argv[1:])
