"""From objects to a scene of Pellicle: what can be simulated, in metres and world coordinates."""

import math
import os
import re
import struct

import bpy
import numpy

from . import yaml

# modifiers that refine or thicken what they get: they stay after the cache and act on the result
AFTER = {"SUBSURF", "SOLIDIFY", "BEVEL", "SMOOTH", "LAPLACIANSMOOTH", "CORRECTIVE_SMOOTH", "WEIGHTED_NORMAL", "TRIANGULATE", "WIREFRAME", "EDGE_SPLIT"}
CACHE = "Pellicle"
PC2_HEAD = struct.Struct("<12siiffi")
PINNED_ABOVE = 0.5


class Part:
    """An object of the simulation.

    name: of the body or tool; vertices: world coordinates in metres (n x 3) of the vertices `kept` of the object's mesh, which triangles use;
    triangles: (m x 3), in numbers of `vertices`; fields: weights of vertex groups (n) by name; track: the object over time;
    follows: whether its animation is written as a cache."""

    def __init__(self, thing, name, vertices, triangles, kept, fields, track):
        self.object, self.name, self.vertices, self.triangles, self.kept, self.fields = thing, name, vertices, triangles, kept, fields
        self.track, self.follows = track, False


class Track:
    """An object over the frames of the scene: matrices to the world in metres, and the vertices of its mesh in its own coordinates.
    Both have one item if they do not change."""

    def __init__(self, is_moving, is_deforming):
        self.is_moving, self.is_deforming = is_moving, is_deforming
        self.matrices, self.poses, self.vertices = [], [], []

    def matrix(self, frame):
        return self.matrices[min(frame, len(self.matrices) - 1)]

    def world(self, frame, kept):
        matrix = self.matrix(frame)
        return self.vertices[min(frame, len(self.vertices) - 1)][kept] @ matrix[:3, :3].T + matrix[:3, 3]


class Setup:
    """What is written: bodies, those that obstacles with a changing shape are, and rigid obstacles (lists of Part), the scene as a map, its
    number of frames, and problems, a text each. Only a setup without problems is whole."""

    def __init__(self):
        self.bodies, self.followers, self.obstacles, self.problems = [], [], [], []
        self.scene, self.frame_count = {}, 0

    def refuse(self, thing, text):
        self.problems.append(f"{thing.name}: {text}" if thing else text)


# ---- meshes ----


def name_of(thing, taken):
    """A name that files, scenes and options can hold, and that no other part has."""
    stem = re.sub(r"[^A-Za-z0-9_-]", "_", thing.name)[:50] or "body"
    name, number = stem, 1
    while name in taken:
        number += 1
        name = f"{stem}_{number}"
    taken.add(name)
    return name


def read_triangles(mesh):
    mesh.calc_loop_triangles()
    triangles = numpy.empty(3 * len(mesh.loop_triangles), dtype=numpy.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    return triangles.reshape(-1, 3)


def read_vertices(mesh):
    vertices = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", vertices)
    return vertices.reshape(-1, 3).astype(float)


def read_weights(thing, group):
    """The weights of a vertex group at all vertices."""
    index = thing.vertex_groups[group].index
    weights = numpy.zeros(len(thing.data.vertices))
    for vertex in thing.data.vertices:
        for entry in vertex.groups:
            if entry.group == index:
                weights[vertex.index] = entry.weight
    return weights


def make_part(setup, thing, track, matrix, names, groups=()):
    """The part of an object at the first frame, under a matrix; None and a problem if it has no surface."""
    triangles = read_triangles(thing.data)
    if len(triangles) == 0:
        setup.refuse(thing, "has no triangles. Add faces, or set its role to None")
        return None
    if track.vertices and len(track.vertices[0]) != len(thing.data.vertices):
        modifier = next(modifier for modifier in thing.modifiers if is_before(modifier))
        kind = modifier.bl_rna.properties["type"].enum_items[modifier.type].name
        setup.refuse(thing, f"the modifier '{modifier.name}' ({kind}) is not applied. Apply it, or switch it off in the viewport")
        return None
    if numpy.linalg.det(matrix[:3, :3]) == 0:
        setup.refuse(thing, "has a scale of 0. Set a scale above 0")
        return None
    if numpy.linalg.det(matrix[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    # loose vertices and edges have no surface
    kept, numbers = numpy.unique(triangles, return_inverse=True)
    vertices = track.vertices[0][kept] @ matrix[:3, :3].T + matrix[:3, 3]
    fields = {field: read_weights(thing, group)[kept] for field, group in groups}
    return Part(thing, name_of(thing, names), vertices, numbers.reshape(-1, 3).astype(numpy.int32), kept, fields, track)


def write_ply(path, part):
    """A binary PLY file with a property for each field."""
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(part.vertices)}"]
    head += [f"property double {axis}" for axis in "xyz"] + [f"property double {name}" for name in part.fields]
    head += [f"element face {len(part.triangles)}", "property list uchar int vertex_indices", "end_header\n"]
    faces = numpy.empty(len(part.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, part.triangles
    with open(path, "wb") as file:
        file.write("\n".join(head).encode())
        file.write(numpy.column_stack([part.vertices, *part.fields.values()]).astype("<f8").tobytes())
        file.write(faces.tobytes())


def write_cache(path, part, frame_count):
    """The animation of a part as a point cache."""
    with open(path, "wb") as file:
        file.write(PC2_HEAD.pack(b"POINTCACHE2\0", 1, len(part.vertices), 0, 1, frame_count))
        for frame in range(frame_count):
            file.write(part.track.world(frame, part.kept).astype("<f4").tobytes())


# ---- objects over time ----


def is_before(modifier):
    """Whether a modifier changes what is simulated; the others act on the result."""
    return modifier.name != CACHE and modifier.type not in AFTER and modifier.show_viewport


def has_motion(data):
    animation = data.animation_data if data else None
    return bool(animation and (animation.action or animation.drivers or animation.nla_tracks))


def is_moving(thing):
    """Whether an object or one of its parents moves by keys, drivers or constraints."""
    while thing is not None:
        if thing.constraints or has_motion(thing):
            return True
        thing = thing.parent
    return False


def is_deforming(thing):
    return any(is_before(modifier) for modifier in thing.modifiers) or has_motion(thing.data.shape_keys)


def sample(scene, things):
    """The tracks of objects over all frames of the scene, which then returns to its frame.

    Results of an earlier bake and modifiers that act on results are hidden meanwhile."""
    scale, now = scene.unit_settings.scale_length, scene.frame_current
    tracks = {thing: Track(is_moving(thing), is_deforming(thing)) for thing in things}
    hidden = [m for thing in things for m in thing.modifiers if m.show_viewport and not is_before(m)]
    for modifier in hidden:
        modifier.show_viewport = False
    changing = any(track.is_moving or track.is_deforming for track in tracks.values())
    for frame in range(scene.frame_start, scene.frame_end + 1 if changing else scene.frame_start + 1):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for thing, track in tracks.items():
            add_frame(track, thing.evaluated_get(graph), scale)
    for modifier in hidden:
        modifier.show_viewport = True
    scene.frame_set(now)
    return tracks


def add_frame(track, seen, scale):
    """The present frame of an evaluated object, if it is the first or differs from it."""
    if track.is_moving or not track.matrices:
        matrix = numpy.array(seen.matrix_world, dtype=float)
        matrix[:3] *= scale
        track.matrices.append(matrix)
        track.poses.append(seen.matrix_world.decompose())
    if track.is_deforming or not track.vertices:
        track.vertices.append(read_vertices(seen.data))


# ---- bodies ----


def collect_groups(setup, thing):
    """Pairs of a field's name and a vertex group, for the groups that the settings name."""
    own, groups = thing.pellicle, []
    for field in "pin", "stiffness", "muscle":
        group = getattr(own, field + "_group")
        if group and group not in thing.vertex_groups:
            setup.refuse(thing, f"has no vertex group '{group}'. Choose another group for {field.capitalize()}")
        elif group:
            groups.append((field, group))
    return groups


def number_or_field(part, value, factor):
    """A modulus, or its values at the weights 0 and 1 of the painted group."""
    if "stiffness" not in part.fields:
        return value
    return {"field": "stiffness", "map": [value, value * factor]}


# Pa, mm, kg/m3 of the presets that are no materials of the program
OWN_NUMBERS = {"tissue": (5000, 1, 1000), "cloth": (5e5, 0.3, 500), "jelly": (1.18e5, 2, 1000)}
# presets with another name in `pellicle presets`
MATERIALS = {"balloon": "latex-balloon"}
# Pa per relative difference of the volume of a filling
BULK = {"jelly": 2e4, "balloon": 1e5}


def sheet(own, part):
    """The keys of a sheet: membrane and mass."""
    given, body = own.use_numbers or own.preset in OWN_NUMBERS, {}
    young, thickness, density = (own.young, own.thickness, own.density) if own.use_numbers else OWN_NUMBERS.get(own.preset, (0, 0, 0))
    membrane = {"preset": MATERIALS.get(own.preset, own.preset)} if own.preset not in OWN_NUMBERS else {"material": "neo-hookean"}
    if given:
        membrane.update(young=number_or_field(part, young, own.stiffness_factor), thickness=thickness / 1000)
        body["mass"] = {"density": density}
    body["membrane"] = membrane
    return body


def material(own, part):
    """The keys of a body that describe its material."""
    if own.preset == "tissue":
        young, _, density = (own.young, 0, own.density) if own.use_numbers else OWN_NUMBERS["tissue"]
        return {
            "mass": {"density": density},
            "springs": {"young": number_or_field(part, 10 * young, own.stiffness_factor)},
            "volumetric": {"young": number_or_field(part, young, own.stiffness_factor)},
        }
    body = sheet(own, part)
    if own.preset == "jelly":
        body["pressure"] = {"volume": {"target": 1, "bulk": BULK["jelly"]}}
        body["fluid"] = {"density": 1000}
    if own.preset == "balloon":
        body["pressure"] = {"volume": {"target": {"keys": [[0, 1], [own.ramp, own.volume_ratio]]}, "bulk": BULK["balloon"]}}
    if "muscle" in part.fields:
        body["anisotropy"] = {
            "mode": "active",
            "region": {"field": "muscle"},
            "rest_length": {"keys": [[0, 1], [own.ramp, 1 - own.contraction]]},
        }
    return body


def check_body(setup, part):
    own, thing = part.object.pellicle, part.object
    if own.preset in BULK and is_open(part.triangles):
        setup.refuse(thing, f"has open edges, and {own.preset} encloses a volume. Close them with Mesh > Clean Up > Fill Holes")
    for field, title in ("pin", "Pin"), ("muscle", "Muscle"):
        if field in part.fields and not (part.fields[field] > PINNED_ABOVE).any():
            setup.refuse(thing, f"no vertex of the group for {title} has a weight above {PINNED_ABOVE}. Paint the group")
    if "muscle" in part.fields and own.preset == "tissue":
        setup.refuse(thing, "Muscle needs a sheet: choose a preset other than Organ")
    if "stiffness" in part.fields and own.preset not in OWN_NUMBERS and not own.use_numbers:
        setup.refuse(thing, "Stiffness needs a number to multiply: switch on Own numbers")


def is_open(triangles):
    """Whether an edge belongs to one triangle only."""
    edges = numpy.sort(numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return bool((numpy.unique(edges, axis=0, return_counts=True)[1] == 1).any())


def body_of(part):
    # vertices keep their numbers, so that the cache fits
    return {"name": part.name, "mesh": {"file": part.name + ".ply", "weld": False}}


def follow_of(part, rate, **region):
    part.follows = True
    return {"file": part.name + "-motion.pc2", "fps": rate, **region}


def add_body(setup, thing, track, rate, names):
    part = make_part(setup, thing, track, track.matrix(0), names, collect_groups(setup, thing))
    if part is None:
        return None
    check_body(setup, part)
    setup.bodies.append(part)
    body = {**body_of(part), **material(thing.pellicle, part)}
    pins = {"field": "pin", "above": PINNED_ABOVE}
    if "pin" in part.fields and (track.is_moving or track.is_deforming):
        body["follow"] = follow_of(part, rate, at=pins)
    elif "pin" in part.fields:
        body["pinned"] = pins
    elif track.is_moving or has_motion(thing.data.shape_keys):
        setup.refuse(thing, "is animated, and nothing would follow its animation. Choose a vertex group for Pin, or set its role to Obstacle")
    return body


# ---- obstacles ----


def motion_keys(poses, rate, scale):
    """The keys of poses, one a frame; those that lie between equal ones are left out."""
    keys = []
    for frame, (place, turn, _) in enumerate(poses):
        axis, angle = turn.to_axis_angle()
        key = {"time": frame / rate, "position": [x * scale for x in place]}
        if angle != 0:
            key["rotation"] = {"axis": list(axis), "angle": math.degrees(angle)}
        same = len(keys) > 1 and all({**key, "time": 0} == {**old, "time": 0} for old in keys[-2:])
        keys[-1:] = [key] if same else keys[-1:] + [key]
    return keys


def add_follower(setup, thing, track, rate, names):
    """An obstacle whose shape changes: a body without a material that follows its animation as a whole."""
    part = make_part(setup, thing, track, track.matrix(0), names)
    if part is None:
        return None
    setup.followers.append(part)
    return {**body_of(part), "follow": follow_of(part, rate)}


def add_obstacle(setup, thing, track, rate, scale, names):
    """A rigid obstacle: a tool whose mesh is the object without its place and rotation."""
    sizes = numpy.array([list(pose[2]) for pose in track.poses])
    if numpy.abs(sizes - sizes[0]).max() > 1e-4 * numpy.abs(sizes[0]).max():
        return add_follower(setup, thing, track, rate, names)
    part = make_part(setup, thing, track, numpy.diag([*(sizes[0] * scale), 1.0]), names)
    if part is None:
        return None
    setup.obstacles.append(part)
    return {"name": part.name, "mesh": {"file": part.name + ".ply"}, "motion": motion_keys(track.poses, rate, scale)}


# ---- the scene ----


def with_role(scene, setup, role):
    things = [thing for thing in scene.objects if thing.pellicle.role == role]
    for thing in things:
        if thing.type != "MESH":
            setup.refuse(thing, "is no mesh. Convert it with Object > Convert > Mesh")
    return [thing for thing in things if thing.type == "MESH"]


def collect(scene):
    """The setup of a scene of Blender, at its first frame."""
    setup, names, own = Setup(), set(), scene.pellicle
    rate, scale = scene.render.fps / scene.render.fps_base, scene.unit_settings.scale_length
    setup.frame_count = scene.frame_end - scene.frame_start + 1
    bodies, obstacles = with_role(scene, setup, "BODY"), with_role(scene, setup, "OBSTACLE")
    if not bodies and not setup.problems:
        setup.refuse(None, "No object is a body. Select a mesh and set its role to Body")
    if setup.frame_count < 2:
        setup.refuse(None, "The scene has one frame. Set a later end frame")
    for thing in bodies + obstacles:
        thing.update_from_editmode()
    tracks = sample(scene, bodies + obstacles)
    parts = [add_body(setup, thing, tracks[thing], rate, names) for thing in bodies]
    changing = [thing for thing in obstacles if tracks[thing].is_deforming]
    parts += [add_follower(setup, thing, tracks[thing], rate, names) for thing in changing]
    rigid = [add_obstacle(setup, thing, tracks[thing], rate, scale, names) for thing in obstacles if thing not in changing]
    # obstacles that change their size are bodies
    parts += [item for item in rigid if item and "follow" in item]
    tools = [item for item in rigid if item and "motion" in item]
    every = own.steps
    # organs stay where springs hold them: those carry their weight at rest
    moves = any(thing.pellicle.preset != "tissue" for thing in bodies)
    setup.scene = {
        "version": 1,
        "title": bpy.path.display_name_from_filepath(bpy.data.filepath) or "from Blender",
        "bodies": parts,
        "tools": tools,
        "gravity": list(scene.gravity) if moves and scene.use_gravity else [0, 0, 0],
        "contact": {"self": own.self_contact, "friction": own.friction},
        "solver": {"dt": 1 / (rate * every)},
        "stop": {"frames": (setup.frame_count - 1) * every},
        "output": {"every_frame": every, "fields": ["displacement"]},
    }
    if own.use_air and moves:
        setup.scene["wind"] = {"velocity": list(own.wind)}
        if own.gusts > 0:
            setup.scene["wind"]["gusts"] = {"speed": own.gusts, "length": 1, "seed": 1}
    return setup


def folder_of(scene):
    """The folder of the scene's files, absolute; a text that says why there is none is the second value."""
    path = scene.pellicle.folder
    if path.startswith("//") and not bpy.data.filepath:
        return None, "Save the file first, or choose a folder that does not begin with //"
    path = os.path.normpath(bpy.path.abspath(path))
    try:
        os.makedirs(path, exist_ok=True)
        probe = os.path.join(path, ".pellicle-probe")
        with open(probe, "wb"):
            pass
        os.remove(probe)
    except OSError as error:
        return None, f"Cannot write into {path}: {error.strerror}. Choose another folder"
    return path, None


def write(setup, folder):
    """Writes the meshes and scene.yaml; returns the path of the scene. Errors of files are OSError."""
    for part in setup.bodies + setup.followers + setup.obstacles:
        write_ply(os.path.join(folder, part.name + ".ply"), part)
        if part.follows:
            write_cache(os.path.join(folder, part.name + "-motion.pc2"), part, setup.frame_count)
    path = os.path.join(folder, "scene.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(yaml.dump(setup.scene))
    return path
