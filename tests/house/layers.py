#!/usr/bin/env python3
"""Checks every #include of src and the other trees against the table of ranks in docs/architecture.md, and that rooms stay small:
at most 20 sources and 5000 lines each, and no cycle of more than 4 files (a source and its header are one) that include each
other.

usage: layers.py ROOT | layers.py --self-test ROOT
"""
import pathlib
import re
import sys
import tempfile

TREES = ("src", "cli", "papers", "view", "python", "include", "examples", "bench")
# trees outside src, and those whose lower ranks they see
SEES = {"papers": {"papers"}, "cli": {"papers"}}
MOST_SOURCES, MOST_LINES, LONGEST_CYCLE = 20, 5000, 4
# outer libraries and the folders that may use them
OUTER = {"libfyaml": {"src/runs/keys"}, "assimp": {"src/runs/foreign"}, "zlib": {"src/shape/io"},
         "pthread": {"src/ground/base", "src/service/haptic", "src/service/live", "cli", "view"},
         "epoxy": {"view"}, "png": {"view"}, "ft2build": {"view"}}
# headers that the build makes, and their folders
MADE = {"law/files.h": "src/physics/law"}


def read_ranks(root):
    """folder -> rank, from the rows `| 3 | `src/shape/io`, ... |`"""
    rows = re.findall(r"^\| (\d+) \| ([^|]+) \|", (root / "docs/architecture.md").read_text(), re.M)
    return {folder: int(rank) for rank, cell in rows for folder in re.findall(r"`([^`]+)`", cell)}


def folder_of(path):
    """src/shape/io/ply.c -> src/shape/io; papers/papers.c -> papers; examples/press/main.c -> examples"""
    return path.parent.as_posix() if path.parts[0] in ("src", "papers") else path.parts[0]


def resolve(root, path, name):
    """the folder of the file that name stands for in the file at path, or None"""
    if name in MADE:
        return MADE[name]
    floors = [floor.relative_to(root) / name for floor in sorted((root / "src").glob("*/"))]
    places = [pathlib.PurePath("include", name), *floors, pathlib.PurePath(name)]
    if not path.parts[0] == "src":
        places.append(path.parent / name)
    return next((folder_of(place) for place in places if (root / place).is_file()), None)


def complaint(root, ranks, path, folder, name):
    """why the file at path may not include name, or None"""
    target = resolve(root, path, name)
    outer = re.split("[/.]", name)[0]
    if target is None and outer in OUTER:
        return None if folder in OUTER[outer] | {"bench"} else f"only {', '.join(OUTER[outer])} may use it"
    if target is None:
        return 'not found; write "room/file.h" or "pellicle/file.h"'
    if target in (folder, "include") or folder == "bench":
        return None
    tree, seen = folder.split("/")[0], target.split("/")[0]
    if tree != "src" and seen not in SEES.get(tree, ()):
        return f"{folder} sees {', '.join(['include/pellicle', 'itself', *SEES.get(tree, ())])} only"
    if ranks.get(target, 99) >= ranks[folder]:
        return f"{folder} has rank {ranks[folder]} and may not see {target}, rank {ranks.get(target, 'unknown')}"
    return None


def floor_problems(ranks):
    """ranks of one floor must not enclose a rank of another, and two rooms must not have one name"""
    floors, rooms, found = {}, {}, []
    for folder, rank in ranks.items():
        if folder.startswith("src/"):
            _, floor, room = folder.split("/")
            floors.setdefault(floor, []).append(rank)
            rooms.setdefault(room, []).append(folder)
    for floor, own in floors.items():
        found += [f"docs/architecture.md: rank {rank} of {other} lies between ranks of {floor}" for other in floors
                  for rank in set(floors[other]) if other != floor and min(own) <= rank <= max(own)]
    return found + [f"docs/architecture.md: rooms of one name: {' '.join(same)}" for same in rooms.values() if len(same) > 1]


def problems(root):
    ranks = read_ranks(root)
    found = floor_problems(ranks)
    for path in sorted(p.relative_to(root) for tree in TREES for p in (root / tree).rglob("*.[ch]*")):
        folder = folder_of(path)
        if folder not in ranks and folder not in ("include", "bench"):
            found.append(f"{path}: folder {folder} has no rank in docs/architecture.md")
            continue
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s*(["<])([^">]+)', line)
            if not match:
                continue
            quote, name = match.groups()
            # an angle include counts when it names something of ours or an outer library
            ours = quote == '"' or resolve(root, path, name) or re.split("[/.]", name)[0] in OUTER
            why = complaint(root, ranks, path, folder, name) if ours else None
            if why:
                found.append(f"{path}:{number}: {name}: {why}")
    return found


def include_cycles(root):
    """sets of files, named room/file without an ending, that include each other"""
    graph = {}
    for path in (root / "src").rglob("*.[ch]"):
        targets = graph.setdefault(f"{path.parent.name}/{path.stem}", set())
        targets |= {name[:-2] for name in re.findall(r'^#include "(\w+/\w+\.h)"', path.read_text(), re.M)}
    reach = {}
    for start in graph:
        seen, waiting = set(), [start]
        while waiting:
            for target in graph.get(waiting.pop(), set()) - seen:
                seen.add(target)
                waiting.append(target)
        reach[start] = seen
    cycles = {frozenset(name for name in reach[start] if start in reach.get(name, ())) for start in graph }
    return [cycle for cycle in cycles if len(cycle) > LONGEST_CYCLE]


def size_problems(root):
    found = [f"files include each other, at most {LONGEST_CYCLE} may: {' '.join(sorted(cycle))}" for cycle in include_cycles(root)]
    for room in sorted((root / "src").glob("*/*/")):
        files = sorted(room.glob("*.[ch]"))
        sources, lines = sum(path.suffix == ".c" for path in files), sum(path.read_text().count("\n") for path in files)
        if sources > MOST_SOURCES or lines > MOST_LINES:
            found.append(f"{room.relative_to(root)}: {sources} sources and {lines} lines, at most {MOST_SOURCES} and {MOST_LINES}: split it")
    return found


def self_test(root):
    """each bad include in a small tree is found, each good one is not"""
    cases = {  # path: (included, bad)
        "src/ground/base/low.h": ("pellicle/base.h", False),
        "src/ground/math/own.c": ("math/vector.h", False),
        "src/ground/math/vector.h": ("base/low.h", False),
        "src/ground/base/upward.c": ("math/vector.h", True),
        "src/shape/mesh/mesh.h": ("math/vector.h", False),
        "src/shape/geom/equal.c": ("mesh/mesh.h", True),
        "src/shape/geom/absent.c": ("math/absent.h", True),
        "src/shape/geom/yaml.c": ("libfyaml.h", True),
        "src/shape/attic/old.c": ("base/low.h", True),
        "src/shape/io/relative.c": ("../base/low.h", True),
        "cli/main.c": ("cli/options.h", False),
        "cli/options.h": ("pellicle/base.h", False),
        "cli/inner.c": ("base/low.h", True),
        "cli/reproduce.c": ("papers/papers.h", False),
        "papers/papers.h": ("papers/b/body.h", False),
        "papers/lab/plot.h": ("pellicle/base.h", False),
        "papers/lab/upward.c": ("papers/b/body.h", True),
        "papers/b/body.h": ("papers/lab/plot.h", False),
        "papers/a/beside.c": ("papers/b/body.h", True),
        "papers/a/program.c": ("cli/options.h", True),
        "papers/a/inner.c": ("base/low.h", True),
        "view/reproduce.c": ("papers/papers.h", True),
        "examples/press/main.c": ("pellicle/base.h", False),
        "examples/press/inner.c": ("mesh/mesh.h", True),
        "bench/step.c": ("mesh/mesh.h", False),
        "include/pellicle/base.h": ("mesh.h", False),
        "include/pellicle/mesh.h": ("math/vector.h", True),
    }
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        (tree / "docs").mkdir()
        (tree / "docs/architecture.md").write_text((root / "docs/architecture.md").read_text())
        for path, (name, _) in cases.items():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            (tree / path).write_text(f'#include "{name}"\n')
        (tree / "src/solver/solve").mkdir(parents=True)
        (tree / "src/solver/solve/angle.c").write_text("#include <libfyaml.h>\n")
        (tree / "src/ground/base/angle.c").write_text("#include <math/vector.h>\n")
        bad = {path for path, (_, is_bad) in cases.items() if is_bad} | {"src/solver/solve/angle.c", "src/ground/base/angle.c"}
        caught = {line.split(":")[0] for line in problems(tree)}
        for i in range(5):
            (tree / f"src/solver/solve/ring{i}.c").write_text(f'#include "solve/ring{i}.h"\n')
            (tree / f"src/solver/solve/ring{i}.h").write_text(f'#include "solve/ring{(i + 1) % 5}.h"\n')
        for i in range(21):
            (tree / f"src/shape/geom/many{i}.c").write_text("\n")
        sizes = size_problems(tree)
    wrong = [f"self-test: {path} should be {'refused' if path in bad else 'allowed'}" for path in sorted(bad ^ caught)]
    if floor_problems({"src/a/x": 0, "src/a/y": 1, "src/b/z": 2}):
        wrong.append("self-test: two floors, one above the other, should be allowed")
    if len(floor_problems({"src/a/x": 0, "src/b/y": 1, "src/a/z": 2})) != 1 or not floor_problems({"src/a/x": 0, "src/b/x": 1}):
        wrong.append("self-test: mixed floors and rooms of one name should be refused")
    if len(sizes) != 2:
        wrong.append(f"self-test: a ring of five files and a room of many should be refused: {sizes}")
    return wrong


def main():
    root = pathlib.Path(sys.argv[-1]).resolve()
    found = self_test(root) if "--self-test" in sys.argv else problems(root) + size_problems(root)
    print("\n".join(found) if found else "ok")
    return 1 if found else 0


sys.exit(main())
