#!/usr/bin/env python3
"""Reads a .usda file by the grammar of USD's text format, checks its meshes by the schema UsdGeomMesh, and prints what it holds.

usage: check_usd.py FILE [PRIM ATTRIBUTE CODE]      with a prim: the values of an attribute at a time code"""
import math
import re
import sys

TOKEN = re.compile(r'\s*(?:#[^\n]*\n\s*)*("(?:[^"\\]|\\.)*"|[A-Za-z_][\w:.]*(?:\[\])?|-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[(){}\[\]=,:])')


class Reader:
    def __init__(self, text):
        head, _, rest = text.partition("\n")
        assert head == "#usda 1.0", head
        self.tokens, at = [], 0
        rest = rest.rstrip()
        while at < len(rest):
            match = TOKEN.match(rest, at)
            assert match, rest[at : at + 40]
            self.tokens.append(match[1])
            at = match.end()
        self.at = 0

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def take(self, wanted=None):
        token = self.peek()
        assert wanted is None or token == wanted, f"{token} instead of {wanted}"
        self.at += 1
        return token

    def value(self):
        token = self.take()
        if token in "([":
            end, values = {"(": ")", "[": "]"}[token], []
            while self.peek() != end:
                values.append(self.value())
                if self.peek() != end:
                    self.take(",")
            self.take(end)
            return values
        if token == "{":
            samples = {}
            while self.peek() != "}":
                code = float(self.take())
                self.take(":")
                samples[code] = self.value()
                self.take(",")
            self.take("}")
            return samples
        return token[1:-1] if token[0] == '"' else float(token)

    def metadata(self):
        entries = {}
        if self.peek() == "(":
            self.take()
            while self.peek() != ")":
                name = self.take()
                self.take("=")
                entries[name] = self.value()
            self.take(")")
        return entries

    def prim(self):
        self.take("def")
        prim = {"type": self.take(), "name": self.take()[1:-1], "children": [], "attributes": {}, "about": {}}
        self.metadata()
        self.take("{")
        while self.peek() != "}":
            if self.peek() == "def":
                prim["children"].append(self.prim())
            else:
                self.attribute(prim)
        self.take("}")
        return prim

    def attribute(self, prim):
        if self.peek() == "uniform":
            self.take()
        kind, name = self.take(), self.take()
        if self.peek() == "=":
            self.take()
            prim["attributes"][name] = (kind, self.value())
        prim["about"].setdefault(name, {}).update(self.metadata())


def samples(values, name):
    """The kind of an attribute and its values by time code; a value without times is at code 0."""
    if name in values:
        kind, value = values[name]
        return kind, {0: value}
    return values[name + ".timeSamples"]


def check_mesh(mesh, codes):
    values = mesh["attributes"]
    counts, indices = values["faceVertexCounts"][1], values["faceVertexIndices"][1]
    kind, points = samples(values, "points")
    assert kind == "point3f[]" and sorted(points) == list(points) == codes
    assert set(counts) == {3} and 3 * len(counts) == len(indices)
    count = len(points[codes[0]])
    assert set(indices) == set(map(float, range(count)))
    assert values["subdivisionScheme"][1] == "none" and mesh["about"]["normals"] == {"interpolation": "vertex"}
    normals, extents = samples(values, "normals")[1], samples(values, "extent")[1]
    for code in codes:
        assert len(points[code]) == len(normals[code]) == count and all(len(point) == 3 for point in points[code])
        assert all(abs(math.hypot(*normal) - 1) < 1e-5 for normal in normals[code])
        assert extents[code] == [[f(point[i] for point in points[code]) for i in range(3)] for f in (min, max)]
    if "primvars:st" in values:
        assert values["primvars:st"][0] == "texCoord2f[]" and mesh["about"]["primvars:st"] == {"interpolation": "vertex"}
        assert len(values["primvars:st"][1]) == count
    return f"{mesh['name']}: {count} vertices, {len(counts)} triangles{', st' if 'primvars:st' in values else ''}"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        reader = Reader(file.read())
    head, root = reader.metadata(), reader.prim()
    assert reader.peek() is None and root["type"] == "Xform" and root["name"] == head["defaultPrim"]
    assert head["upAxis"] == "Z" and head["metersPerUnit"] == 1
    meshes = root["children"]
    assert all(re.fullmatch(r"[A-Za-z_]\w*", mesh["name"]) for mesh in meshes) and len({mesh["name"] for mesh in meshes}) == len(meshes)
    is_timed = "points" not in meshes[0]["attributes"]
    codes = list(samples(meshes[0]["attributes"], "points")[1])
    if is_timed:
        assert codes[0] == head["startTimeCode"] and codes[-1] == head["endTimeCode"]
        assert head["framesPerSecond"] == head["timeCodesPerSecond"]
    else:
        assert "startTimeCode" not in head and "timeCodesPerSecond" not in head
    parts = [check_mesh(mesh, codes) for mesh in meshes]
    if len(sys.argv) > 2:
        _, prim, name, code = sys.argv[1:]
        value = next(mesh for mesh in meshes if mesh["name"] == prim)["attributes"][name][1]
        rows = value[float(code)] if isinstance(value, dict) else value
        print(" ".join(f"{number:.9g}" for row in rows for number in row))
    else:
        print("; ".join(parts) + (f", {len(codes)} frames at {head['timeCodesPerSecond']:.9g} codes/s to {codes[-1]:.9g}" if is_timed else ""))


main()
