#!/usr/bin/env python3
"""Reads a .vtp file by VTK's description of the format alone and prints name, components, sum of the values of each array."""
import re
import struct
import sys
import xml.etree.ElementTree as ElementTree
import zlib

LETTERS = {"Float32": "f", "Float64": "d", "Int32": "i"}


def unpack(data, at, compressed):
    if not compressed:
        (size,) = struct.unpack_from("<Q", data, at)
        return data[at + 8 : at + 8 + size]
    count, whole, last = struct.unpack_from("<3Q", data, at)
    sizes = struct.unpack_from(f"<{count}Q", data, at + 24)
    at += 24 + 8 * count
    out = b""
    for i, size in enumerate(sizes):
        block = zlib.decompress(data[at : at + size])
        assert len(block) == (last if i == count - 1 and last else whole)
        out += block
        at += size
    return out


def read_arrays(path):
    """name -> (components, numbers) of all arrays, in their order"""
    content = open(path, "rb").read()
    head = re.match(rb'(.*)<AppendedData encoding="raw">\s*_', content, re.S)
    data = content[head.end() :]
    assert data.endswith(b"\n</AppendedData>\n</VTKFile>\n")
    root = ElementTree.fromstring(head.group(1) + b"</VTKFile>")
    assert root.get("header_type") == "UInt64" and root.get("byte_order") == "LittleEndian"
    arrays = {}
    for array in root.iter("DataArray"):
        values = unpack(data, int(array.get("offset")), root.get("compressor") is not None)
        letter = LETTERS[array.get("type")]
        numbers = struct.unpack(f"<{len(values) // struct.calcsize(letter)}{letter}", values)
        components = int(array.get("NumberOfComponents"))
        assert len(numbers) == components * int(array.get("NumberOfTuples"))
        arrays[array.get("Name")] = components, numbers
    return arrays


if __name__ == "__main__":
    for name, (components, numbers) in read_arrays(sys.argv[1]).items():
        print(name, components, len(numbers), "%.6f" % sum(numbers))
