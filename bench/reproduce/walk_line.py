"""Turns what `vismat walk --summary` wrote into a line of a table: walk_line.py SUMMARY.json NAME=VALUE ... | walk_line.py --header"""
import json
import sys

COLUMNS = ["scene", "path", "varied", "value", "system", "disk", "cache_bytes", "prefetch_depth", "frames", "frames_without_cell", "crossings",
           "jumps", "seconds", "requests", "hits", "reads", "bytes", "prefetched", "evicted", "overflow", "most_cached_bytes", "stalled_frames",
           "stalled_frames_after_the_first_cell", "stall_ms", "p99_stall_ms", "worst_stall_ms", "mean_frame_ms", "frame_ms_variance",
           "mean_triangles", "mean_objects", "mean_versions", "images", "missing_pixels", "wrong_pixels", "extra_pixels"]

if sys.argv[1] == "--header":
    print(",".join(COLUMNS))
else:
    with open(sys.argv[1], encoding="utf-8") as file:
        values = json.load(file)
    values.update(pair.split("=", 1) for pair in sys.argv[2:])
    print(",".join(str(values[column]) for column in COLUMNS))
