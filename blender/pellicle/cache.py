"""The result of a run on the objects: point caches in their own coordinates, played by modifiers."""

import os
import struct

import bpy
import numpy

from .export import CACHE

HEAD = struct.Struct("<12siiffi")


class BadCache(Exception):
    """A point cache that does not belong to the setup, or is damaged."""


def read_head(file, path):
    head = file.read(HEAD.size)
    if len(head) < HEAD.size or not head.startswith(b"POINTCACHE2"):
        raise BadCache(f"{path} is no point cache. Bake again")
    _, _, vertex_count, _, _, frame_count = HEAD.unpack(head)
    return vertex_count, frame_count


def local_vertices(part, matrix, inverse, world):
    """World coordinates of a part's vertices, in metres, to those of the whole mesh in its own coordinates."""
    mesh = part.object.data
    vertices = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", vertices)
    vertices = vertices.reshape(-1, 3).astype(float)
    vertices[part.kept] = (world - matrix[:3, 3]) @ inverse.T
    return vertices.astype("<f4")


def split(setup, source, folder, matrices):
    """Divides the cache of all bodies into one for each object; returns their paths and the number of frames.

    matrices: of each body, from its own coordinates to the world in metres. Files of an earlier bake stay until all new ones are whole."""
    paths = [os.path.join(folder, part.name + ".pc2") for part in setup.bodies]
    inverses = [numpy.linalg.inv(matrix[:3, :3]) for matrix in matrices]
    starts = numpy.cumsum([0] + [len(part.vertices) for part in setup.bodies])
    with open(source, "rb") as file:
        vertex_count, frame_count = read_head(file, source)
        if vertex_count != starts[-1]:
            raise BadCache(f"the result has {vertex_count} vertices and the bodies have {starts[-1]}. Bake again")
        outputs = [open(path + ".part", "wb") for path in paths]
        try:
            for part, output in zip(setup.bodies, outputs):
                output.write(HEAD.pack(b"POINTCACHE2\0", 1, len(part.object.data.vertices), 0, 1, frame_count))
            for _ in range(frame_count):
                frame = numpy.frombuffer(file.read(12 * vertex_count), dtype="<f4").reshape(-1, 3)
                for i, (part, output) in enumerate(zip(setup.bodies, outputs)):
                    world = frame[starts[i] : starts[i + 1]].astype(float)
                    output.write(local_vertices(part, matrices[i], inverses[i], world).tobytes())
        finally:
            for output in outputs:
                output.close()
    for path in paths:
        os.replace(path + ".part", path)
    return paths, frame_count


def attach(thing, path, first_frame):
    """Plays a cache on an object by the first of its modifiers."""
    modifier = thing.modifiers.get(CACHE) or thing.modifiers.new(CACHE, "MESH_CACHE")
    modifier.cache_format = "PC2"
    modifier.filepath = bpy.path.relpath(path) if bpy.data.filepath else path
    modifier.play_mode = "SCENE"
    modifier.frame_start = first_frame
    # both are in the object's own coordinates
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"
    modifier.show_in_editmode = False
    with bpy.context.temp_override(object=thing, active_object=thing):
        bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)


def detach(thing):
    """Takes the cache off an object; returns whether there was one."""
    modifier = thing.modifiers.get(CACHE)
    if modifier is not None:
        thing.modifiers.remove(modifier)
    return modifier is not None
