#!/usr/bin/env python3
"""Reads the frames of runs with VTK, as ParaView does, and compares every array with the bytes of the file.

usage: vtk_frames.py PROGRAM; exits with 77 (skipped) where Debian's python3-vtk9 is missing
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

DEBIAN_PYTHON = "/usr/bin/python3"
try:
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN_PYTHON) and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON, *sys.argv])
    print("missing: python3-vtk9")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from check_vtp import read_arrays  # noqa: E402

SCENE = """version: 1
bodies:
  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 6 }, mass: { per_vertex: 1 },
      springs: { stiffness: 3, damping: 0.5 }, volumetric: { stiffness: 1.5, damping: 0.5 }, REFINE }
  - { name: lens, mesh: { shape: lens-capsule, scale: 100, translate: [5, 0, 0] }, mass: { per_vertex: 1 },
      springs: { stiffness: 3, damping: 0.5 } }
tools:
  - { name: probe, shape: sphere, radius: 0.25, body: ball,
      motion: [{ time: 0, position: [0, 0, 1.35] }, { time: 0.3, position: [0, 0, 1.0] }] }
solver: { dt: 0.01 }
duration: 0.3
output: { every: 0.05, fields: [FIELDS], compress: COMPRESS, precision: PRECISION }
"""
FIELDS = ["displacement", "velocity", "force", "energy", "spring_energy", "volumetric_energy", "contact", "area",
          "normal", "mean_curvature", "gaussian_curvature", "stress", "thickness"]


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def values_of(array):
    count, components = array.GetNumberOfTuples(), array.GetNumberOfComponents()
    return [array.GetComponent(i, c) for i in range(count) for c in range(components)]


def open_edges(data):
    edges = vtkFeatureEdges()
    edges.SetInputData(data)
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def check_frame(path, time):
    arrays, data = {name: numbers for name, (_, numbers) in read_arrays(path).items()}, read(path)
    points = data.GetPointData()
    names = {points.GetArrayName(i) for i in range(points.GetNumberOfArrays())}
    assert names == set(arrays) - {"TimeValue", "Points", "connectivity", "offsets"}, names
    assert values_of(data.GetFieldData().GetArray("TimeValue")) == [time]
    for name in names:
        assert values_of(points.GetArray(name)) == list(arrays[name]), name
    assert values_of(data.GetPoints().GetData()) == list(arrays["Points"])
    cells = data.GetPolys()
    assert values_of(cells.GetConnectivityArray()) == list(arrays["connectivity"])
    assert values_of(cells.GetOffsetsArray())[1:] == list(arrays["offsets"])
    assert open_edges(data) == 0
    return names, data.GetNumberOfCells()


def check_run(program, folder, refine, compress, precision):
    scene = SCENE.replace("REFINE", refine).replace("FIELDS", ", ".join(FIELDS))
    path = folder / "scene.yaml"
    path.write_text(scene.replace("COMPRESS", compress).replace("PRECISION", precision))
    run = folder / f"run-{bool(refine)}-{compress}-{precision}"
    subprocess.run([program, "run", str(path), "-o", str(run), "--quiet"], check=True)
    frames = ElementTree.parse(run / "frames.pvd").getroot().findall("Collection/DataSet")
    counts = set()
    tools = [frame for frame in frames if frame.get("part") != "0"]
    frames = [frame for frame in frames if frame.get("part") == "0"]
    for tool in tools:
        check_frame(run / tool.get("file"), float(tool.get("timestep")))
    assert [tool.get("timestep") for tool in tools] == [frame.get("timestep") for frame in frames]
    for frame in frames:
        names, count = check_frame(run / frame.get("file"), float(frame.get("timestep")))
        counts.add(count)
        assert set(FIELDS) | {"body"} <= names
        assert {"level", "mesh_vertices", "mesh_weights"} <= names or not refine
    assert len(frames) == 7 and (len(counts) > 1) == bool(refine), counts
    print(f"{run.name}: {len(frames)} frames, {len(names)} fields, {sorted(counts)} triangles")


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        for refine in "", "refine: { levels: 2, above: 1, dwell: 5, interval: 3 }":
            for compress, precision in ("false", "single"), ("true", "double"):
                check_run(program, pathlib.Path(folder), refine, compress, precision)


main()
