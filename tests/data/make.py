#!/usr/bin/env python3
"""Makes the meshes of this folder from generated spheres: shapes as irregular as scanned organs, free of rights.

usage: make.py PROGRAM (from this folder)
"""
import math
import subprocess
import sys


def sphere(frequency):
    subprocess.run([sys.argv[1], "shape", "geodesic-sphere", "--set", f"frequency={frequency}", "-o", "sphere.obj"],
                   check=True, stdout=subprocess.DEVNULL)
    words = [line.split() for line in open("sphere.obj", encoding="utf-8")]
    subprocess.run(["rm", "sphere.obj"], check=True)
    vertices = [tuple(map(float, w[1:4])) for w in words if w and w[0] == "v"]
    triangles = [tuple(int(corner) for corner in w[1:4]) for w in words if w and w[0] == "f"]
    return vertices, triangles


def write(name, vertices, triangles):
    with open(name, "w", encoding="utf-8") as file:
        file.write("# made by tests/data/make.py\n")
        file.writelines("v %.5f %.5f %.5f\n" % vertex for vertex in vertices)
        file.writelines("f %d %d %d\n" % triangle for triangle in triangles)


def bean(x, y, z):
    """a lobe that is bent, with bumps and triangles of uneven size [m]"""
    bump = 1 + 0.12 * math.sin(5 * x + 1) * math.cos(4 * y) + 0.07 * math.sin(9 * z + 2 * x)
    length, width = 0.11 * bump, 0.05 * bump * (1 + 0.35 * x)
    return length * x, width * y + 0.05 * x * x, 0.8 * width * z * (1 - 0.2 * y)


def sac(x, y, z):
    """a bladder with a narrow neck [m]"""
    neck = 0.45 + 0.55 / (1 + math.exp(7 * (z - 0.45)))
    wave = 1 + 0.05 * math.sin(6 * x) * math.sin(5 * y + z)
    return 0.018 * x * neck * wave, 0.016 * y * neck * wave, 0.034 * z + 0.004 * x * x


def main():
    vertices, triangles = sphere(9)
    write("bean.obj", [bean(*vertex) for vertex in vertices], triangles)
    vertices, triangles = sphere(7)
    write("sac.obj", [sac(*vertex) for vertex in vertices], triangles)
    # the upper part of a lobe: open, with a ragged rim
    vertices, triangles = sphere(8)
    kept = [t for t in triangles if sum(vertices[v - 1][2] for v in t) > 0.3]
    number = {v: i + 1 for i, v in enumerate(sorted({v for t in kept for v in t}))}
    write("flap.obj", [bean(*vertices[v - 1]) for v in number], [tuple(number[v] for v in t) for t in kept])


main()
