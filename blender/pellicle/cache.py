"""The result of a run on the objects: point caches in their own coordinates, played by modifiers."""

import os

import bpy
import numpy

from .export import CACHE, PC2_HEAD, is_before


class BadCache(Exception):
    """A point cache that does not belong to the setup, or is damaged."""


def read_head(file, path):
    head = file.read(PC2_HEAD.size)
    if len(head) < PC2_HEAD.size or not head.startswith(b"POINTCACHE2"):
        raise BadCache(f"{path} is no point cache. Bake again")
    _, _, vertex_count, _, _, frame_count = PC2_HEAD.unpack(head)
    return vertex_count, frame_count


def local_vertices(part, frame, world):
    """World coordinates of a part's vertices, in metres, to those of the whole mesh in the object's own coordinates."""
    matrix, track = part.track.matrix(frame), part.track
    vertices = track.vertices[min(frame, len(track.vertices) - 1)].copy()
    vertices[part.kept] = numpy.linalg.solve(matrix[:3, :3], (world - matrix[:3, 3]).T).T
    return vertices.astype("<f4")


def split(setup, source, folder):
    """Divides the cache of all bodies into one for each object; returns their paths and the number of frames. Files of an earlier bake stay
    until all new ones are whole."""
    paths = [os.path.join(folder, part.name + ".pc2") for part in setup.bodies]
    starts = numpy.cumsum([0] + [len(part.vertices) for part in setup.bodies + setup.followers])
    with open(source, "rb") as file:
        vertex_count, frame_count = read_head(file, source)
        if vertex_count != starts[-1]:
            raise BadCache(f"the result has {vertex_count} vertices and the bodies have {starts[-1]}. Bake again")
        outputs = [open(path + ".part", "wb") for path in paths]
        try:
            for part, output in zip(setup.bodies, outputs):
                output.write(PC2_HEAD.pack(b"POINTCACHE2\0", 1, len(part.object.data.vertices), 0, 1, frame_count))
            for frame in range(frame_count):
                all_vertices = numpy.frombuffer(file.read(12 * vertex_count), dtype="<f4").reshape(-1, 3)
                for i, (part, output) in enumerate(zip(setup.bodies, outputs)):
                    world = all_vertices[starts[i] : starts[i + 1]].astype(float)
                    output.write(local_vertices(part, frame, world).tobytes())
        finally:
            for output in outputs:
                output.close()
    for path in paths:
        os.replace(path + ".part", path)
    return paths, frame_count


def attach(thing, path, first_frame):
    """Plays a cache on an object, by a modifier behind those that are simulated and before those that act on the result."""
    modifier = thing.modifiers.get(CACHE) or thing.modifiers.new(CACHE, "MESH_CACHE")
    modifier.cache_format = "PC2"
    modifier.filepath = bpy.path.relpath(path) if bpy.data.filepath else path
    modifier.play_mode = "SCENE"
    modifier.frame_start = first_frame
    # both are in the object's own coordinates
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"
    modifier.show_in_editmode = False
    others = [other for other in thing.modifiers if other != modifier]
    index = max((i + 1 for i, other in enumerate(others) if is_before(other)), default=0)
    with bpy.context.temp_override(object=thing, active_object=thing):
        bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=index)


def detach(thing):
    """Takes the cache off an object; returns whether there was one."""
    modifier = thing.modifiers.get(CACHE)
    if modifier is not None:
        thing.modifiers.remove(modifier)
    return modifier is not None
