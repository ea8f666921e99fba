"""Plays a run in Blender: a mesh with the point cache of `pellicle convert` in a Mesh Cache modifier.

    pellicle convert results/ball ball.pc2          # also writes ball-bodies.obj
    blender --python tools/blender_play.py -- ball-bodies.obj ball.pc2

Options after the two files: --check ball.obj prints the largest distance between the frames in Blender and the numbered files
ball_00000.obj, ... of `pellicle convert results/ball ball.obj`; --picture out.png draws the last frame. Both also work without
a window (blender --background ...).
"""
import argparse
import struct
import sys

import bpy


def read_obj(path):
    vertices, faces = [], []
    with open(path) as lines:
        for line in lines:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append(tuple(float(word) for word in words[1:4]))
            elif words[:1] == ["f"]:
                faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return vertices, faces


def make_object(mesh_path, cache_path):
    vertices, faces = read_obj(mesh_path)
    mesh = bpy.data.meshes.new("pellicle")
    mesh.from_pydata(vertices, [], faces)
    body = bpy.data.objects.new("pellicle", mesh)
    bpy.context.scene.collection.objects.link(body)
    cache = body.modifiers.new("frames", "MESH_CACHE")
    cache.cache_format = "PC2"
    cache.filepath = cache_path
    cache.play_mode = "SCENE"
    # the first frame of Blender is 1 by default
    cache.frame_start = 0
    # both files have z up, like the run
    cache.forward_axis = "POS_Y"
    cache.up_axis = "POS_Z"
    with open(cache_path, "rb") as file:
        signature, version, vertex_count, start, rate, frames = struct.unpack("<12siiffi", file.read(32))
    if vertex_count != len(vertices):
        sys.exit(f"{cache_path} has {vertex_count} vertices and {mesh_path} has {len(vertices)}. "
                 "take both from the same run")
    bpy.context.scene.frame_start = 0
    bpy.context.scene.frame_end = frames - 1
    return body


def check(body, path):
    """Largest distance, over all frames, between a vertex in Blender and in the numbered file."""
    scene, largest, moved = bpy.context.scene, 0.0, 0.0
    stem, first = path.removesuffix(".obj"), None
    for frame in range(scene.frame_end + 1):
        scene.frame_set(frame)
        seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
        expected, _ = read_obj(f"{stem}_{frame:05d}.obj")
        first = first or expected
        for vertex, place, start in zip(seen, expected, first):
            largest = max(largest, max(abs(a - b) for a, b in zip(vertex.co, place)))
            moved = max(moved, max(abs(a - b) for a, b in zip(vertex.co, start)))
    print(f"blender {bpy.app.version_string}: {scene.frame_end + 1} frames, {len(seen)} vertices, "
          f"largest motion {moved:.6g} m, largest difference {largest:.3g} m")
    if largest > 1e-6 * max(1.0, moved) or moved == 0:
        sys.exit("error: the vertices in Blender differ from those of the run")


def draw(body, path):
    scene = bpy.context.scene
    for other in [o for o in bpy.data.objects if o is not body]:
        bpy.data.objects.remove(other)
    scene.frame_set(scene.frame_end)
    corners = [body.matrix_world @ vertex.co for vertex in body.data.vertices]
    low = [min(c[i] for c in corners) for i in range(3)]
    high = [max(c[i] for c in corners) for i in range(3)]
    size, centre = max(h - l for l, h in zip(low, high)), [(l + h) / 2 for l, h in zip(low, high)]
    light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
    light.rotation_euler = (0.6, 0.3, 0.4)
    light.data.energy = 3
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (centre[0], centre[1] - 2.6 * size, centre[2] + 0.9 * size)
    camera.rotation_euler = (1.24, 0, 0)
    for thing in light, camera:
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 8
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = 640, 480
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser(prog="blender_play.py")
    parser.add_argument("mesh")
    parser.add_argument("cache")
    parser.add_argument("--check", metavar="OBJ")
    parser.add_argument("--picture", metavar="PNG")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    body = make_object(arguments.mesh, arguments.cache)
    if arguments.check:
        check(body, arguments.check)
    if arguments.picture:
        draw(body, arguments.picture)


main()
