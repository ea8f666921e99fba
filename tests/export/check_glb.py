#!/usr/bin/env python3
"""Reads a .glb file by the specification of glTF 2.0 alone and prints what it holds; every number must have its place."""
import json
import struct
import sys

LETTERS = {5125: "I", 5126: "f"}
COUNTS = {"SCALAR": 1, "VEC3": 3}


def read_chunks(content):
    magic, version, length = struct.unpack_from("<4sII", content)
    assert magic == b"glTF" and version == 2 and length == len(content)
    at, chunks = 12, []
    while at < length:
        size, kind = struct.unpack_from("<I4s", content, at)
        assert size % 4 == 0
        chunks.append((kind, content[at + 8 : at + 8 + size]))
        at += 8 + size
    assert at == length and [kind for kind, _ in chunks] == [b"JSON", b"BIN\0"]
    return json.loads(chunks[0][1]), chunks[1][1]


def read_accessor(scene, data, index):
    """the tuples of an accessor; its bounds, where given, must be theirs to the last bit"""
    accessor = scene["accessors"][index]
    view = scene["bufferViews"][accessor["bufferView"]]
    width, letter = COUNTS[accessor["type"]], LETTERS[accessor["componentType"]]
    stride, start = view.get("byteStride", 4 * width), accessor.get("byteOffset", 0)
    assert stride == 4 * width and start % 4 == 0
    assert start + stride * accessor["count"] <= view["byteLength"]
    format = f"<{width * accessor['count']}{letter}"
    numbers = struct.unpack_from(format, data, view.get("byteOffset", 0) + start)
    tuples = [numbers[i : i + width] for i in range(0, len(numbers), width)]
    for name, pick in (("min", min), ("max", max)):
        if name in accessor:
            assert accessor[name] == [pick(t[i] for t in tuples) for i in range(width)], (name, index)
    return tuples


def check_cover(scene, data):
    """the views lie one behind the other and fill the buffer, and so do the accessors in each view"""
    end = 0
    for v, view in enumerate(scene["bufferViews"]):
        assert view["buffer"] == 0 and view.get("byteOffset", 0) == end
        end += view["byteLength"]
        inner = 0
        for accessor in (a for a in scene["accessors"] if a["bufferView"] == v):
            assert accessor.get("byteOffset", 0) == inner
            inner += 4 * COUNTS[accessor["type"]] * accessor["count"]
        assert inner == view["byteLength"]
    assert scene["buffers"] == [{"byteLength": end}] and end == len(data)


def check_animation(scene, data, frame_count):
    (animation,) = scene["animations"]
    (sampler,) = animation["samplers"]
    nodes = range(len(scene["nodes"]))
    assert animation["channels"] == [{"sampler": 0, "target": {"node": n, "path": "weights"}} for n in nodes]
    times = [t for (t,) in read_accessor(scene, data, sampler["input"])]
    weights = [w for (w,) in read_accessor(scene, data, sampler["output"])]
    assert {"min", "max"} <= scene["accessors"][sampler["input"]].keys()
    assert len(times) == frame_count and times == sorted(set(times))
    assert weights == [float(k == f) for f in range(frame_count) for k in range(1, frame_count)]


def check_mesh(scene, data, mesh):
    """counts of vertices, triangles and frames"""
    (primitive,) = mesh["primitives"]
    assert 0 <= primitive["material"] < len(scene["materials"])
    targets = primitive.get("targets", [])
    parts = [primitive["attributes"]] + targets
    indices = [i for (i,) in read_accessor(scene, data, primitive["indices"])]
    for part in parts:
        count = len(read_accessor(scene, data, part["POSITION"]))
        assert {"min", "max"} <= scene["accessors"][part["POSITION"]].keys()
        assert len(read_accessor(scene, data, part["NORMAL"])) == count
    assert len(indices) % 3 == 0 and 0 <= min(indices) and max(indices) < count
    assert len({part[key] for part in parts for key in ("POSITION", "NORMAL")}) == 2 * len(parts)
    assert mesh.get("weights", []) == [0] * len(targets) and ("weights" in mesh) == bool(targets)
    return count, len(indices) // 3, len(parts)


def main():
    scene, data = read_chunks(open(sys.argv[1], "rb").read())
    check_cover(scene, data)
    assert [node["mesh"] for node in scene["nodes"]] == list(range(len(scene["meshes"])))
    assert scene["scenes"] == [{"nodes": list(range(len(scene["nodes"])))}]
    counts = [check_mesh(scene, data, mesh) for mesh in scene["meshes"]]
    (frame_count,) = {frames for _, _, frames in counts}
    if frame_count > 1:
        check_animation(scene, data, frame_count)
    else:
        assert "animations" not in scene
    said = [
        node.get("name", "") + (": " if "name" in node else "") + f"{vertices} vertices, {triangles} triangles"
        for node, (vertices, triangles, _) in zip(scene["nodes"], counts)
    ]
    print("; ".join(said) + f", {frame_count} frames")


main()
