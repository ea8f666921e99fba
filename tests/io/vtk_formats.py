#!/usr/bin/env python3
"""Reads what VTK writes, in every encoding, byte order and width of header, and compares it with what VTK holds.

usage: vtk_formats.py PROGRAM; exits with 77 (skipped) where Debian's python3-vtk9 is missing
"""
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile

DEBIAN_PYTHON = "/usr/bin/python3"
try:
    from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIntArray, vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkStripper, vtkTriangleFilter
    from vtkmodules.vtkFiltersSources import vtkCylinderSource, vtkSphereSource
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(DEBIAN_PYTHON) and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON, *sys.argv])
    print("missing: python3-vtk9")
    sys.exit(77)

COUNTS = ("vertices", "triangles", "boundary_edges", "euler_characteristic")


def made(kind, **numbers):
    """an object of VTK with some of its numbers set"""
    thing = kind()
    for name, value in numbers.items():
        getattr(thing, "Set" + name)(value)
    return thing


def output_of(source):
    source.Update()
    return source.GetOutput()


def make_meshes():
    """a large sphere with normals, and one with a double, an int and a name to be escaped; polygons; strips"""
    sphere = made(vtkSphereSource, ThetaResolution=90, PhiResolution=70)
    normals = made(vtkPolyDataNormals, Splitting=False)
    normals.SetInputData(output_of(sphere))
    plain = output_of(normals)
    fields = vtkPolyData()
    fields.DeepCopy(output_of(vtkSphereSource()))
    for kind, name in ((vtkDoubleArray, "a < b"), (vtkIntArray, "number")):
        array = kind()
        array.SetName(name)
        for v in range(fields.GetNumberOfPoints()):
            array.InsertNextValue(v / 3 if kind is vtkDoubleArray else 7 * v)
        fields.GetPointData().AddArray(array)
    cylinder = output_of(made(vtkCylinderSource, Resolution=12))
    stripper = vtkStripper()
    stripper.SetInputData(output_of(vtkSphereSource()))
    return {"plain": plain, "fields": fields, "polygons": cylinder, "strips": output_of(stripper)}


def write(data, path, mode, compress, wide, order):
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(mode, writer.SetDataModeToAppended)()
    writer.SetEncodeAppendedData(mode == "appended base64")
    (writer.SetCompressorTypeToZLib if compress else writer.SetCompressorTypeToNone)()
    (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
    (writer.SetByteOrderToBigEndian if order else writer.SetByteOrderToLittleEndian)()
    assert writer.Write() == 1


def triangles_of(data):
    """as VTK cuts it up"""
    filter_ = made(vtkTriangleFilter, PassVerts=False, PassLines=False)
    filter_.SetInputData(data)
    return output_of(filter_)


def read_back(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    return output_of(reader)


def compare(name, data, back):
    """what the program wrote with what it was given: the same points and fields, as many triangles"""
    assert back.GetNumberOfPoints() == data.GetNumberOfPoints(), name
    assert back.GetNumberOfPolys() == triangles_of(data).GetNumberOfPolys(), name
    for v in range(data.GetNumberOfPoints()):
        assert back.GetPoint(v) == data.GetPoint(v), (name, v)
    for f in range(data.GetPointData().GetNumberOfArrays()):
        wanted = data.GetPointData().GetArray(f)
        found = back.GetPointData().GetArray(wanted.GetName())
        assert found is not None, (name, wanted.GetName())
        for i in range(wanted.GetNumberOfTuples()):
            assert tuple(wanted.GetTuple(i)) == tuple(found.GetTuple(i)), (name, wanted.GetName(), i)


def info(program, path):
    result = subprocess.run([program, "info", "--json", path], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        path, copy = pathlib.Path(folder, "in.vtp"), pathlib.Path(folder, "out.vtp")
        for name, data in make_meshes().items():
            modes = ("ascii", "binary", "appended", "appended base64")
            for mode, compress, wide, order in itertools.product(modes, (False, True), (False, True), (False, True)):
                if name == "plain" and order:
                    continue
                what = f"{name}, {mode}, compressed {compress}, wide {wide}, big endian {order}"
                write(data, path, mode, compress, wide, order)
                result = subprocess.run([program, "convert", path, copy, "-q"], capture_output=True, text=True, check=False)
                assert result.returncode == 0, f"{what}: {result.stderr}"
                compare(what, data, read_back(copy))
                count += 1
            found = info(program, path)
            assert found["triangles"] == triangles_of(data).GetNumberOfPolys()
            subprocess.run([program, "measure", path], check=name != "strips", capture_output=True)
            subprocess.run([program, "check", path, "--no-intersections"], check=False, capture_output=True)
        # no surface, and a compressor that is not known: refused with a remedy
        points = vtkPoints()
        points.InsertNextPoint(0, 0, 0)
        lone = vtkPolyData()
        lone.SetPoints(points)
        lone.SetVerts(vtkCellArray())
        write(lone, path, "ascii", False, False, False)
        result = subprocess.run([program, "info", path], capture_output=True, text=True, check=False)
        assert result.returncode == 2 and "point clouds" in result.stderr, result.stderr
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(output_of(vtkSphereSource()))
        writer.SetCompressorTypeToLZ4()
        writer.Write()
        result = subprocess.run([program, "info", path], capture_output=True, text=True, check=False)
        assert result.returncode == 2 and "ZLib" in result.stderr, result.stderr
    print(f"{count} files of VTK read")


main()
