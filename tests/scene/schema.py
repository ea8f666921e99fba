#!/usr/bin/env python3
"""Holds scenes against the JSON Schema of docs/reference: what the program accepts the schema accepts.

usage: schema.py PROGRAM SOURCE; exits with 77 (skipped) where Debian's python3-jsonschema or python3-yaml is missing

The scenes are those of scenes/ and examples/, of the command-line tests and of the documentation, and what runs write
about themselves. A scene that the program refuses is left out; some with a plain mistake must be refused by both.
"""
import copy
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

DEBIAN_PYTHON = "/usr/bin/python3"
try:
    import jsonschema
    import yaml
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN_PYTHON) and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON, *sys.argv])
    print("missing: python3-jsonschema or python3-yaml")
    sys.exit(77)


class Loader(yaml.SafeLoader):
    """the core schema of YAML 1.2: `on` is text and 1e-3 a number"""


CORE = {
    "bool": (r"true|True|TRUE|false|False|FALSE", "tTfF"),
    "int": (r"[-+]?[0-9]+", "-+0123456789"),
    "float": (r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "-+0123456789."),
    "null": (r"~|null|Null|NULL|", ["~", "n", "N", ""]),
}
Loader.yaml_implicit_resolvers = {}
for tag, (pattern, first) in CORE.items():
    Loader.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{pattern})$"), list(first))


def without_nulls(value):
    """a key without value counts as left out"""
    if isinstance(value, dict):
        return {key: without_nulls(entry) for key, entry in value.items() if entry is not None}
    return [without_nulls(entry) for entry in value] if isinstance(value, list) else value


def scenes_of_cases(path):
    """the files that a command-line test writes"""
    name, lines = None, []
    for line in path.read_text().splitlines():
        if name is None and line.startswith("file "):
            name, lines = line[5:], []
        elif name is not None and line == "end":
            if name.endswith((".yaml", ".yml")):
                yield f"{path.name}: {name}", "\n".join(lines) + "\n"
            name = None
        elif name is not None:
            lines.append(line)


def scenes_of_text(path):
    """whole scenes in the code blocks of a page"""
    for number, block in enumerate(re.findall(r"```yaml\n(.*?)```", path.read_text(), re.S)):
        if block.startswith("version:"):
            yield f"{path.name}: block {number}", block


def scenes_of_code(path):
    """string literals of a test that hold a whole scene"""
    literals = r'(?:"(?:[^"\\\n]|\\.)*"\s*)+'
    for number, found in enumerate(re.findall(literals, path.read_text())):
        text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', found))
        text = text.replace("\\n", "\n").replace('\\"', '"')
        if text.startswith("version: 1\n") and "bodies" in text and "%" not in text:
            yield f"{path.name}: string {number}", text


def all_scenes(source):
    for folder in ("scenes", "examples"):
        for path in sorted((source / folder).rglob("*.yaml")):
            yield str(path.relative_to(source)), path.read_text()
    for path in sorted((source / "tests" / "cli" / "cases").glob("*.txt")):
        yield from scenes_of_cases(path)
    for path in sorted((source / "tests").rglob("*.[ch]")):
        yield from scenes_of_code(path)
    for path in sorted([source / "README.md", *(source / "docs").rglob("*.md")]):
        yield from scenes_of_text(path)


def accepts(program, folder, text):
    """the program's word; files that a scene names are not there, and are not what this is about"""
    path = pathlib.Path(folder, "scene.yaml")
    path.write_text(text)
    result = subprocess.run([program, "check", path, "--no-intersections"], capture_output=True, text=True, check=False)
    return result.returncode == 0


def explain(error):
    leaves = [error]
    while any(leaf.context for leaf in leaves):
        leaves = [part for leaf in leaves for part in (leaf.context or [leaf])]
    deepest = max(leaves, key=lambda leaf: len(leaf.absolute_path))
    return f"{list(deepest.absolute_path)}: {deepest.message[:200]}"


def mistakes(scene):
    """the same scene with a plain mistake"""
    for change in (
        lambda s: s.update(nonsense=1),
        lambda s: s.update(version=2),
        lambda s: s.pop("bodies"),
        lambda s: s["bodies"][0].update(mesh=7),
        lambda s: s["bodies"][0].update(colour="red"),
        lambda s: s.setdefault("solver", {}).update(method="magic"),
        lambda s: s.setdefault("solver", {}).update(dt=-1),
    ):
        other = copy.deepcopy(scene)
        change(other)
        yield other


def main():
    program, source = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
    schema = json.loads((source / "docs" / "reference" / "scene.schema.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    checked, shipped, failures = 0, 0, []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in all_scenes(source):
            is_shipped = name.startswith("scenes/")
            if not is_shipped and not accepts(program, folder, text):
                continue
            scene = without_nulls(yaml.load(text, Loader))
            failures += [f"{name}: refused: {explain(error)}" for error in validator.iter_errors(scene)]
            checked, shipped = checked + 1, shipped + is_shipped
            if is_shipped:
                failures += [f"{name}: a mistake passes" for other in mistakes(scene) if validator.is_valid(other)]
        run = pathlib.Path(folder, "run")
        for name in ("sphere-press", "balloon"):
            subprocess.run([program, "run", source / "scenes" / f"{name}.yaml", "-q", "--frames", "1", "-o", run],
                           check=True, capture_output=True)
            resolved = without_nulls(yaml.load((run / "scene.yaml").read_text(), Loader))
            failures += [f"resolved {name}: {explain(error)}" for error in validator.iter_errors(resolved)]
    print(f"{checked} scenes, {shipped} of them shipped, {len(failures)} failures", *failures, sep="\n")
    sys.exit(1 if failures or shipped < 5 or checked < 30 else 0)


main()
