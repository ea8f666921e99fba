#!/usr/bin/env python3
"""Checks every #include against the table of ranks in docs/architecture.md.

usage: layers.py ROOT | layers.py --self-test ROOT
"""
import pathlib
import re
import sys
import tempfile

TREES = ("src", "cli", "papers", "view", "python", "include", "examples", "bench")
# trees outside src, and those whose lower ranks they see
SEES = {"papers": {"papers"}, "cli": {"papers"}}
# outer libraries and the folders that may use them
OUTER = {"libfyaml": {"src/scene"}, "assimp": {"src/scene"}, "zlib": {"src/io"}, "pthread": {"src/base", "src/haptic", "src/live", "cli", "view"},
         "epoxy": {"view"}, "png": {"view"}, "ft2build": {"view"},
         "libwebsockets": {"src/live"}}


def read_ranks(root):
    """folder -> rank, from the rows `| 3 | `src/io`, ... |`"""
    rows = re.findall(r"^\| (\d+) \| ([^|]+) \|", (root / "docs/architecture.md").read_text(), re.M)
    return {folder: int(rank) for rank, cell in rows for folder in re.findall(r"`([^`]+)`", cell)}


def folder_of(path):
    """src/io/ply.c -> src/io; papers/papers.c -> papers; examples/press/main.c -> examples"""
    return path.parent.as_posix() if path.parts[0] in ("src", "papers") else path.parts[0]


def resolve(root, path, name):
    """the folder of the file that name stands for in the file at path, or None"""
    places = [pathlib.PurePath("include", name), pathlib.PurePath("src", name), pathlib.PurePath(name)]
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
        return 'not found; write "folder/file.h" or "pellicle/file.h"'
    if target in (folder, "include") or folder == "bench":
        return None
    tree, seen = folder.split("/")[0], target.split("/")[0]
    if tree != "src" and seen not in SEES.get(tree, ()):
        return f"{folder} sees {', '.join(['include/pellicle', 'itself', *SEES.get(tree, ())])} only"
    if ranks.get(target, 99) >= ranks[folder]:
        return f"{folder} has rank {ranks[folder]} and may not see {target}, rank {ranks.get(target, 'unknown')}"
    return None


def problems(root):
    ranks = read_ranks(root)
    found = []
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


def self_test(root):
    """each bad include in a small tree is found, each good one is not"""
    cases = {  # path: (included, bad)
        "src/base/low.h": ("pellicle/base.h", False),
        "src/math/own.c": ("math/vector.h", False),
        "src/math/vector.h": ("base/low.h", False),
        "src/base/upward.c": ("math/vector.h", True),
        "src/mesh/mesh.h": ("math/vector.h", False),
        "src/geom/equal.c": ("mesh/mesh.h", True),
        "src/geom/absent.c": ("math/absent.h", True),
        "src/geom/yaml.c": ("libfyaml.h", True),
        "src/attic/old.c": ("base/low.h", True),
        "src/io/relative.c": ("../base/low.h", True),
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
        (tree / "src/solve").mkdir()
        (tree / "src/solve/angle.c").write_text("#include <libfyaml.h>\n")
        (tree / "src/base/angle.c").write_text("#include <math/vector.h>\n")
        bad = {path for path, (_, is_bad) in cases.items() if is_bad} | {"src/solve/angle.c", "src/base/angle.c"}
        caught = {line.split(":")[0] for line in problems(tree)}
    return [f"self-test: {path} should be {'refused' if path in bad else 'allowed'}" for path in sorted(bad ^ caught)]


def main():
    root = pathlib.Path(sys.argv[-1]).resolve()
    found = self_test(root) if "--self-test" in sys.argv else problems(root)
    print("\n".join(found) if found else "ok")
    return 1 if found else 0


sys.exit(main())
