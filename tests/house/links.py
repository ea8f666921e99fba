#!/usr/bin/env python3
"""Checks the graph of links: which object file of src/ and papers/ needs which other one.

Reads the symbols of the built objects. Files of different rooms form no cycle, files of one room none of more than
LIMIT files.

usage: links.py SOURCE_DIR BUILD_DIR NM | links.py --self-test
"""
import pathlib
import re
import subprocess
import sys

LIMIT = 4


def read_symbols(source, build, nm):
    """file, src/ left out -> (symbols that it defines, symbols that it needs)"""
    paths = {}
    objects = [path for tree in ("src", "papers") for path in build.glob(f"CMakeFiles/*.dir/{tree}/**/*.c.o")]
    for path in sorted(objects):
        name = re.search(r"\.dir/(.*)\.c\.o", path.as_posix()).group(1)
        # objects of sources that are no more stay in the build folder
        if (source / f"{name}.c").is_file():
            paths[path.as_posix()] = name.removeprefix("src/")
    files = {name: (set(), set()) for name in paths.values()}
    listed = subprocess.run([nm, "-A", *paths], capture_output=True, text=True, check=True).stdout if paths else ""
    for line in listed.splitlines():
        path, rest = line.rsplit(":", 1)
        kind, symbol = rest.split()[-2:]
        defined, needed = files[paths[path]]
        if kind == "U":
            needed.add(symbol)
        elif kind in "TDRBCVW":
            defined.add(symbol)
    return files


def link_graph(files):
    """file -> {file that it needs: [symbols]}"""
    owner = {symbol: name for name, (defined, _) in files.items() for symbol in defined}
    graph = {name: {} for name in files}
    for name, (_, needed) in files.items():
        for symbol in sorted(needed):
            target = owner.get(symbol, name)
            if target != name:
                graph[name].setdefault(target, []).append(symbol)
    return graph


def find_cycles(graph):
    """sets of files that all need each other, directly or not"""
    def reach(edges, start):
        seen, waiting = set(), [start]
        while waiting:
            for target in edges.get(waiting.pop(), ()):
                if target not in seen:
                    seen.add(target)
                    waiting.append(target)
        return seen

    back = {}
    for name, targets in graph.items():
        for target in targets:
            back.setdefault(target, []).append(name)
    cycles, done = [], set()
    for name in graph:
        if name not in done:
            cycle = reach(graph, name) & reach(back, name)
            done |= cycle
            if len(cycle) > 1:
                cycles.append(cycle)
    return cycles


def is_allowed(cycle):
    return len({name.rsplit("/", 1)[0] for name in cycle}) == 1 and len(cycle) <= LIMIT


def describe(cycle, graph):
    lines = [f"cycle of {len(cycle)} files: {' '.join(sorted(cycle))}"]
    for name in sorted(cycle):
        for target in sorted(set(graph[name]) & cycle):
            lines.append(f"    {name} -> {target}: {' '.join(graph[name][target])}")
    return "\n".join(lines)


def problems(files):
    graph = link_graph(files)
    return [describe(cycle, graph) for cycle in find_cycles(graph) if not is_allowed(cycle)]


def ring(names):
    """files that need each other in turn"""
    return {name: ({f"of_{name}"}, {f"of_{names[(i + 1) % len(names)]}", "malloc"}) for i, name in enumerate(names)}


def self_test():
    """which graphs are refused"""
    cases = [
        ("a chain over folders", {"a/x": ({"f"}, {"g"}), "b/y": ({"g"}, set())}, False),
        ("a ring of four in a folder", ring(["a/1", "a/2", "a/3", "a/4"]), False),
        ("a ring of five in a folder", ring(["a/1", "a/2", "a/3", "a/4", "a/5"]), True),
        ("two files of two folders", ring(["a/1", "b/2"]), True),
        ("two rings that share a file", ring(["a/1", "a/2", "a/3"]) | {
            "a/3": ({"of_a/3"}, {"of_a/1", "of_a/4"}), "a/4": ({"of_a/4"}, {"of_a/5"}),
            "a/5": ({"of_a/5"}, {"of_a/3"})}, True),
    ]
    return [f"self-test: {name} should be {'refused' if bad else 'allowed'}"
            for name, files, bad in cases if bool(problems(files)) != bad]


def main():
    if "--self-test" in sys.argv:
        found = self_test()
    else:
        source, build = (pathlib.Path(argument) for argument in sys.argv[1:3])
        files = read_symbols(source, build, sys.argv[3])
        found = problems(files) if len(files) > 100 else [f"only {len(files)} objects found in {build}"]
    print("\n".join(found) if found else "ok")
    return 1 if found else 0


sys.exit(main())
