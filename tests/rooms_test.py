"""Each room includes only what it uses: rooms_test.py SOURCE rooms.txt

A room is a folder that is a CMake target. rooms.txt has one line for each room, "FOLDER: ROOM ...", with the rooms that CMake links
to it. The test fails if an include line reaches another room, if rooms use one another in a circle, or if a folder with sources is
no room. A room within another may also include a header of the outer room that includes nothing of the inner ones, only types.
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)


def read_rooms(path):
    rooms = {}
    for line in path.read_text().splitlines():
        folder, _, uses = line.partition(":")
        rooms[folder] = [use for use in re.split(r"[ ;]+", uses.strip()) if use]
    return rooms


def reachable(rooms, folder, path=()):
    """All rooms that `folder` uses, directly or not; complains of a circle."""
    if folder in path:
        raise SystemExit("rooms use one another in a circle: " + " -> ".join((*path, folder)))
    found = set()
    for use in rooms[folder]:
        if use not in rooms:
            raise SystemExit(f"{folder} uses {use}, which is no room")
        found |= {use} | reachable(rooms, use, (*path, folder))
    return found


def room_of(file):
    return str(pathlib.PurePosixPath(file).parent)


def faults_of(source, rooms):
    files = [p.relative_to(source) for top in sorted({r.split("/")[0] for r in rooms})
             for p in sorted((source / top).rglob("*")) if p.suffix in (".h", ".cpp")]
    includes = {str(f): INCLUDE.findall((source / f).read_text()) for f in files}
    may_use = {room: reachable(rooms, room) | {room} for room in rooms}
    for file, lines in includes.items():
        room = room_of(file)
        if room not in rooms:
            yield f"{file}: its folder is no room; give it a vismat_room in CMake"
            continue
        for line in lines:
            target = room_of(line)
            if line not in includes:
                yield f"{file} includes {line}, which is in no room"
            elif target in may_use[room]:
                continue
            elif room.startswith(target + "/"):
                inner = [i for i in includes[line] if room_of(i).startswith(target + "/")]
                if inner or line.removesuffix(".h") + ".cpp" in includes:
                    yield f"{file} includes {line} of the room around it, which is more than types"
            else:
                yield f"{file} includes {line}; {room} does not use {target}"


def self_test():
    """What it must find, on a tree made for it."""
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        tree = {"low/a.h": "", "low/a.cpp": '#include "high/b.h"\n', "high/b.h": '#include "low/a.h"\n', "high/in/c.h": '#include "high/b.h"\n',
                "high/in/d.h": '#include "high/e.h"\n', "high/e.h": '#include "high/in/c.h"\n', "lost/f.h": "", "low/sub/g.h": ""}
        for name, text in tree.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        found = list(faults_of(root, {"low": [], "high": ["low", "high/in"], "high/in": []}))
    expected = ["low/a.cpp includes high/b.h; low does not use high", "high/in/d.h includes high/e.h of the room around it",
                "low/sub/g.h: its folder is no room"]
    for text in expected:
        assert any(text in fault for fault in found), (text, found)
    assert len(found) == len(expected), found
    try:
        reachable({"a": ["b"], "b": ["a"]}, "a")
    except SystemExit:
        return
    raise AssertionError("a circle was not found")


def main():
    source, rooms = pathlib.Path(sys.argv[1]), read_rooms(pathlib.Path(sys.argv[2]))
    self_test()
    faults = list(faults_of(source, rooms))
    print("\n".join(faults))
    if faults:
        raise SystemExit(f"{len(faults)} include lines go where their room does not")
    print(f"{len(rooms)} rooms, each including only what it uses")


main()
