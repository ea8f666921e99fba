"""The add-on in Blender without a window: blender -b --factory-startup -P tests/blender/test_addon.py -- PROGRAM [--zip ZIP] [--picture PNG]

Bakes scenes with the program and compares what Blender shows with the frames of the run. Prints each test; exits with 1 if one fails."""

import argparse
import os
import struct
import sys
import tempfile
import traceback

import bpy
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.dont_write_bytecode = True
parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("--zip", help="the add-on as it is installed; default: that of this tree")
parser.add_argument("--picture", metavar="PNG")
arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
if arguments.zip:
    bpy.ops.preferences.addon_install(filepath=arguments.zip)
else:
    sys.path.insert(0, os.path.join(ROOT, "blender"))
import pellicle  # noqa: E402
from pellicle import export, operators, yaml  # noqa: E402
from pellicle.job import FAILED, RUNNING  # noqa: E402

FOLDER = tempfile.mkdtemp()


# ---- scenes ----


def clear():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, 11, 24
    scene.unit_settings.scale_length = 1
    scene.pellicle.folder = os.path.join(FOLDER, "bake")
    scene.pellicle.use_air = False
    return scene


def add(kind, role, preset="cloth", **keys):
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**keys)
    thing = bpy.context.object
    thing.pellicle.role, thing.pellicle.preset = role, preset
    return thing


def paint(thing, name, weight_of):
    """A vertex group with weights by the place of each vertex."""
    group = thing.vertex_groups.new(name=name)
    for vertex in thing.data.vertices:
        group.add([vertex.index], weight_of(vertex.co), "REPLACE")
    return name


def bake():
    try:
        return bpy.ops.pellicle.bake(wait=True) == {"FINISHED"}
    except RuntimeError:  # a report of an error
        return False


def shown(thing, frame):
    """World coordinates of an object's vertices at a frame."""
    bpy.context.scene.frame_set(frame)
    seen = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return numpy.array([seen.matrix_world @ vertex.co for vertex in seen.data.vertices])


def result_frames():
    """Frames of the cache of the whole run (frames x vertices x 3), in metres and world coordinates."""
    with open(os.path.join(FOLDER, "bake", "result.pc2"), "rb") as file:
        _, _, count, _, _, frames = struct.unpack("<12siiffi", file.read(32))
        return numpy.frombuffer(file.read(), dtype="<f4").reshape(frames, count, 3)


def messages():
    return bpy.context.scene.pellicle.messages


def refuses(word):
    assert not bake(), "baked"
    assert word in messages() and "error:" in messages(), f"{word!r} is not in {messages()!r}"
    bpy.context.scene.pellicle.messages = ""


# ---- tests ----


def test_pinned_cloth():
    """A sheet of quads with UVs and a material, turned, scaled and mirrored, hangs from its pins: Blender shows the run."""
    scene = clear()
    cloth = add("grid", "BODY", size=1, x_subdivisions=8, y_subdivisions=8, rotation=(0.4, 0.2, 0.7), location=(0.3, -0.2, 2))
    cloth.scale = (-0.5, 1.2, 1)
    bpy.context.view_layer.update()
    cloth.data.materials.append(bpy.data.materials.new("linen"))
    cloth.pellicle.pin_group = paint(cloth, "held", lambda co: 1 if co.y > 0.49 else 0.2)
    quads, uvs = len(cloth.data.polygons), len(cloth.data.uv_layers)
    cloth.modifiers.new("smooth", "SUBSURF").show_viewport = False
    assert bake(), messages()
    frames = result_frames()
    assert len(frames) == 11
    start, end = shown(cloth, 1), shown(cloth, 11)
    size = numpy.abs(start).max()
    assert numpy.abs(start - frames[0]).max() < 1e-6 * size
    for frame in 2, 7, 11:
        assert numpy.abs(shown(cloth, frame) - frames[frame - 1]).max() < 2e-6 * size
    pinned = numpy.array([vertex.co.y > 0.49 for vertex in cloth.data.vertices])
    assert numpy.abs(end - start)[pinned].max() < 1e-6
    # 10 frames of free fall are 0.85 m; the pins hold it back
    fall = (start - end)[:, 2].max()
    assert 0.1 < fall < 0.86, fall
    # mesh, UVs, materials and modifiers are those of before; the cache comes first
    assert len(cloth.data.polygons) == quads and len(cloth.data.uv_layers) == uvs == 1
    assert [material.name for material in cloth.data.materials] == ["linen"]
    assert [modifier.name for modifier in cloth.modifiers] == ["Pellicle", "smooth"]
    assert bake() and [modifier.name for modifier in cloth.modifiers] == ["Pellicle", "smooth"]
    bpy.ops.pellicle.clear()
    assert numpy.abs(shown(cloth, 11) - start).max() < 1e-6 and scene.pellicle.messages == ""


def test_free_fall():
    """A sheet without pins falls by g t^2 / 2, in a scene of centimetres too."""
    for scale in 1, 0.01:
        scene = clear()
        scene.unit_settings.scale_length = scale
        cloth = add("grid", "BODY", size=0.5 / scale, x_subdivisions=4, y_subdivisions=4, location=(0, 0, 1 / scale))
        assert bake(), messages()
        fall = (shown(cloth, 1) - shown(cloth, 11))[:, 2] * scale
        expected = 9.81 / 2 * (10 / 24) ** 2
        assert numpy.abs(fall / expected - 1).max() < 0.04, (fall, expected)


def test_two_bodies_and_obstacle():
    """A jelly and a cloth on an animated plate: each object has its own cache, and the plate carries both."""
    clear()
    jelly = add("uv_sphere", "BODY", "jelly", radius=0.1, segments=16, ring_count=10, location=(0, 0, 0.13))
    cloth = add("grid", "BODY", "cloth", size=0.3, x_subdivisions=6, y_subdivisions=6, location=(0.5, 0, 0.05))
    plate = add("cube", "OBSTACLE", size=1, location=(0.25, 0, -0.05))
    plate.scale = (1.5, 1, 0.1)
    plate.keyframe_insert("location", frame=1)
    plate.location.z = 0.15
    plate.keyframe_insert("location", frame=11)
    assert bake(), messages()
    assert numpy.abs(numpy.concatenate([shown(jelly, 8), shown(cloth, 8)]) - result_frames()[7]).max() < 2e-6
    top = shown(plate, 11)[:, 2].max()
    assert abs(top - 0.2) < 1e-6
    for thing in jelly, cloth:
        lowest = shown(thing, 11)[:, 2].min()
        assert top < lowest < top + 0.06, (thing.name, lowest)


def test_turning_obstacle():
    """A bar that turns by 120 degrees sweeps a cloth aside: positions and rotations of keys are those of the object."""
    scene = clear()
    add("grid", "BODY", size=0.2, x_subdivisions=3, y_subdivisions=3, location=(0, 0, 5))
    bar = add("cube", "OBSTACLE", size=1, location=(1, 2, 0))
    bar.scale = (1, 0.1, 0.2)
    bar.keyframe_insert("rotation_euler", frame=1)
    bar.rotation_euler = (0.3, -0.5, 2.1)
    bar.keyframe_insert("rotation_euler", frame=11)
    setup = export.collect(scene)
    assert setup.problems == []
    keys = setup.scene["tools"][0]["motion"]
    mesh = setup.obstacles[0]
    for frame in 1, 4, 11:
        key = next(key for key in keys if abs(key["time"] - (frame - 1) / 24) < 1e-9)
        turn = key.get("rotation", {"axis": [0, 0, 1], "angle": 0})
        axis, angle = numpy.array(turn["axis"]), numpy.radians(turn["angle"])
        cross = numpy.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        matrix = numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross
        assert numpy.abs(mesh.vertices @ matrix.T + key["position"] - shown(bar, frame)).max() < 1e-5
    # a fixed obstacle has one key or two
    bar.animation_data_clear()
    assert len(export.collect(scene).scene["tools"][0]["motion"]) <= 2


def test_followers():
    """A cloth that is pinned to an animated object, on an obstacle that an armature bends and another one that grows."""
    scene = clear()
    cloth = add("grid", "BODY", size=0.4, x_subdivisions=8, y_subdivisions=8, location=(0, 0, 0.5))
    cloth.pellicle.pin_group = paint(cloth, "pin", lambda co: 1 if co.x < -0.19 else 0)
    cloth.keyframe_insert("location", frame=1)
    cloth.location = (0.1, 0, 0.7)
    cloth.rotation_euler = (0, 0, 0.3)
    cloth.keyframe_insert("location", frame=11)
    cloth.keyframe_insert("rotation_euler", frame=11)
    wave = add("grid", "OBSTACLE", size=1, x_subdivisions=12, y_subdivisions=12, location=(0, 0, 0.2))
    wave.shape_key_add(name="Basis")
    bent = wave.shape_key_add(name="bent")
    for point in bent.data:
        point.co.z = 0.2 * point.co.x ** 2
    bent.value = 0
    bent.keyframe_insert("value", frame=1)
    bent.value = 1
    bent.keyframe_insert("value", frame=11)
    ball = add("uv_sphere", "OBSTACLE", radius=0.1, segments=12, ring_count=8, location=(2, 0, 0))
    ball.keyframe_insert("scale", frame=1)
    ball.scale = (2, 2, 2)
    ball.keyframe_insert("scale", frame=11)
    wanted = shown(cloth, 11)
    bent_wave = shown(wave, 6)
    assert bake(), messages()
    pins = numpy.array([vertex.co.x < -0.19 for vertex in cloth.data.vertices])
    assert numpy.abs(shown(cloth, 11) - wanted)[pins].max() < 1e-5
    assert numpy.abs(shown(cloth, 11) - wanted)[~pins].max() > 0.05
    count = len(cloth.data.vertices)
    frames = result_frames()
    assert numpy.abs(shown(cloth, 6) - frames[5, :count]).max() < 2e-6
    assert numpy.abs(bent_wave - frames[5, count : count + len(bent_wave)]).max() < 2e-6
    assert frames.shape[1] == count + len(bent_wave) + len(ball.data.vertices)
    assert len(wave.modifiers) == len(ball.modifiers) == 0


def test_posed_body():
    """A body that a modifier deforms starts as it is seen; the cache comes behind this modifier."""
    clear()
    cloth = add("grid", "BODY", size=0.4, x_subdivisions=8, y_subdivisions=8, location=(0, 0, 1))
    bend = cloth.modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis, bend.angle = "TWIST", "X", 0.8
    cloth.modifiers.new("fine", "SUBSURF").show_viewport = False
    seen = shown(cloth, 1)
    assert bake(), messages()
    assert numpy.abs(shown(cloth, 1) - seen).max() < 1e-6 and numpy.ptp(seen[:, 2]) > 0.01
    assert [modifier.name for modifier in cloth.modifiers] == ["bend", "Pellicle", "fine"]
    assert (shown(cloth, 1) - shown(cloth, 11))[:, 2].min() > 0.5


def test_groups():
    """Stiffness, muscle and presets reach the run."""
    clear()
    sheet = add("grid", "BODY", "silicone", size=0.1, x_subdivisions=8, y_subdivisions=8)
    bpy.context.scene.use_gravity = False
    sheet.pellicle.muscle_group = paint(sheet, "muscle", lambda co: 1)
    sheet.pellicle.contraction, sheet.pellicle.ramp = 0.4, 0.2
    assert bake(), messages()
    areas = [numpy.ptp(shown(sheet, frame), axis=0)[:2].prod() for frame in (1, 11)]
    assert areas[1] < 0.9 * areas[0], areas
    bpy.context.scene.use_gravity = True
    # a painted stiffness halves the sag
    sags = []
    for factor in 1, 100:
        clear()
        organ = add("grid", "BODY", "cloth", size=0.1, x_subdivisions=6, y_subdivisions=6)
        organ.pellicle.pin_group = paint(organ, "pin", lambda co: 1 if abs(co.x) > 0.049 else 0)
        organ.pellicle.stiffness_group = paint(organ, "stiff", lambda co: 1)
        organ.pellicle.use_numbers, organ.pellicle.young = True, 2000
        organ.pellicle.stiffness_factor = factor
        assert bake(), messages()
        sags.append((shown(organ, 1) - shown(organ, 11))[:, 2].max())
    assert sags[1] < 0.5 * sags[0], sags


def test_balloon():
    """A balloon has the volume that was asked for."""
    clear()
    ball = add("ico_sphere", "BODY", "balloon", subdivisions=3, radius=0.05)
    bpy.context.scene.use_gravity = False
    ball.pellicle.volume_ratio, ball.pellicle.ramp = 2, 0.3
    assert bake(), messages()
    bpy.context.scene.use_gravity = True
    radius = [numpy.linalg.norm(shown(ball, frame), axis=1).mean() for frame in (1, 11)]
    assert abs((radius[1] / radius[0]) ** 3 - 2) < 0.1, radius


def test_stop():
    """A stopped bake keeps the frames until then."""
    scene = clear()
    scene.frame_end, scene.pellicle.steps = 400, 20
    cloth = add("grid", "BODY", size=1, x_subdivisions=30, y_subdivisions=30, location=(0, 0, 9))
    folder, setup, program = operators.prepare(bpy.context, need_program=True)
    bake_now = operators.Bake(scene, setup, folder, program)
    while bake_now.job.progress < 0.01 and bake_now.poll() == RUNNING:
        pass
    assert 0 < scene.pellicle.progress < 1
    bake_now.job.stop()
    while bake_now.poll() == RUNNING:
        pass
    assert bake_now.job.state == "stopped", messages()
    count = int(messages().split()[1])
    assert 1 <= count < 400 and len(result_frames()) == count
    assert scene.pellicle.progress == -1 and cloth.modifiers[0].name == "Pellicle"


def test_refusals():
    """What cannot be simulated is told in the panel, with the object and a remedy."""
    scene = clear()
    refuses("No object is a body")
    thing = add("cube", "BODY", size=1)
    mirror = thing.modifiers.new("m", "MIRROR")
    refuses("Cube: the modifier 'm' (Mirror) is not applied")
    mirror.show_viewport = False
    thing.pellicle.pin_group = "gone"
    refuses("has no vertex group 'gone'")
    thing.pellicle.pin_group = paint(thing, "weak", lambda co: 0.3)
    refuses("weight above 0.5")
    thing.pellicle.pin_group = ""
    thing.scale = (1, 0, 1)
    bpy.context.view_layer.update()
    refuses("scale of 0")
    thing.scale = (1, 1, 1)
    thing.keyframe_insert("location", frame=1)
    refuses("is animated")
    thing.animation_data_clear()
    scene.frame_end = 1
    refuses("one frame")
    scene.frame_end = 11
    wire = bpy.data.objects.new("wire", bpy.data.meshes.new("wire"))
    scene.collection.objects.link(wire)
    wire.pellicle.role = "OBSTACLE"
    refuses("wire: has no triangles")
    wire.pellicle.role = "BODY"
    refuses("wire: has no triangles")
    bpy.data.objects.remove(wire)
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    scene.collection.objects.link(lamp)
    lamp.pellicle.role = "BODY"
    refuses("lamp: is no mesh")
    bpy.data.objects.remove(lamp)
    sheet = add("grid", "BODY", "jelly", size=1, location=(5, 0, 0))
    refuses("has open edges")
    bpy.data.objects.remove(sheet)
    blocked = os.path.join(FOLDER, "file")
    with open(blocked, "w"):
        pass
    scene.pellicle.folder = os.path.join(blocked, "inside")
    refuses("Cannot write into")
    scene.pellicle.folder = "//pellicle"
    refuses("Save the file first")
    scene.pellicle.folder = os.path.join(FOLDER, "bake")
    preferences().program = "/no/such/program"
    refuses("The program pellicle is not found")
    preferences().program = arguments.program


def test_errors_of_the_program():
    """An error of the program names the object, and nothing is put on it."""
    clear()
    one = add("cube", "BODY", size=1, location=(0, 0, 0))
    add("cube", "BODY", size=1, location=(0.5, 0.3, 0.2))
    refuses("intersect")
    assert len(one.modifiers) == 0 and operators.current is None


def test_write():
    """The written scene is the one that the program checks."""
    clear()
    add("uv_sphere", "BODY", "tissue", radius=0.1)
    assert bpy.ops.pellicle.write() == {"FINISHED"}
    path = os.path.join(FOLDER, "bake", "scene.yaml")
    assert os.system(f"'{arguments.program}' check '{path}' >/dev/null") == 0
    text = yaml.dump({"a": [1, 2.5], "b": {"c": "x: y", "d": True}, "e": [{"f": list(range(60)), "g": "true"}], "h": {}})
    assert text.startswith('a: [1, 2.5]\nb: { c: "x: y", d: true }\ne:\n  - f: [0, 1,') and 'g: "true"' in text and text.endswith("h: {}\n")


def test_figure():
    """Bones and a shape key of a glTF file that Blender writes: `follow` has the places that Blender has."""
    scene = clear()
    arm = add("cylinder", "NONE", vertices=16, radius=0.1, depth=2, location=(0, 0, 1))
    arm.shape_key_add(name="Basis")
    thick = arm.shape_key_add(name="thick")
    for point in thick.data:
        point.co.x *= 1.5
    bpy.ops.object.armature_add(location=(0, 0, 0))
    bones = bpy.context.object
    bones.rotation_euler, bones.scale = (0.3, 0.2, 0.1), (1.5, 1.5, 1.5)
    bpy.ops.object.mode_set(mode="EDIT")
    bones.data.edit_bones[0].tail = (0, 0, 1)
    upper = bones.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 0, 1), (0, 0, 2), bones.data.edit_bones[0]
    bpy.ops.object.mode_set(mode="OBJECT")
    arm.select_set(True)
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    pose = bones.pose.bones["upper"]
    pose.rotation_mode = "QUATERNION"
    for frame, angle, value in ((1, 0, 0), (5, 1.2, 0.3), (11, -0.8, 1)):
        pose.rotation_quaternion = (numpy.cos(angle / 2), numpy.sin(angle / 2), 0, 0)
        pose.keyframe_insert("rotation_quaternion", frame=frame)
        bones.location = (frame / 11, 0, 0)
        bones.keyframe_insert("location", frame=frame)
        thick.value = value
        thick.keyframe_insert("value", frame=frame)
    os.makedirs(os.path.join(FOLDER, "figure"), exist_ok=True)
    bpy.ops.export_scene.gltf(filepath=os.path.join(FOLDER, "figure", "arm.glb"))
    path = os.path.join(FOLDER, "figure", "scene.yaml")
    with open(path, "w") as file:
        file.write("""{ version: 1, bodies: [ { name: arm, mesh: { file: arm.glb }, follow: { file: arm.glb } },
            { name: sheet, mesh: { shape: grid, size_x: 1, size_y: 1, translate: [0, 0, -9] }, membrane: { preset: rubber } } ],
            solver: { dt: 0.0416666666666666 }, duration: 0.45, output: { every_frame: 1 } }""")
    folder = os.path.join(FOLDER, "figure", "run")
    assert os.system(f"'{arguments.program}' run '{path}' -q -o '{folder}'") == 0
    # Blender writes frame 1 at 1 / 24 s
    for frame in range(1, 11):
        name = os.path.join(FOLDER, "figure", f"{frame}.obj")
        assert os.system(f"'{arguments.program}' convert '{folder}/frames/f{frame:05}.vtp' '{name}' -q") == 0
        with open(name) as file:
            places = numpy.array([line.split()[1:4] for line in file if line.startswith("v ")], dtype=float)
        wanted = shown(arm, frame)[:, [0, 2, 1]] * (1, 1, -1)
        apart = numpy.linalg.norm(wanted[:, None] - places[None], axis=2).min(axis=1)
        assert apart.max() < 2e-6, (frame, apart.max())


def test_package():
    """The manifest of Blender 4.2 agrees with bl_info and the program; the panels draw; the add-on can be removed."""
    with open(os.path.join(ROOT, "blender", "pellicle", "blender_manifest.toml")) as file:
        manifest = file.read()
    version = ".".join(str(part) for part in pellicle.bl_info["version"])
    said = os.popen(f"'{arguments.program}' --version").read()
    assert f'version = "{version}"' in manifest and version in said, (version, said)
    bpy.ops.preferences.addon_disable(module="pellicle")
    assert not hasattr(bpy.types.Scene, "pellicle")
    bpy.ops.preferences.addon_enable(module="pellicle")
    preferences().program = arguments.program


def preferences():
    return bpy.context.preferences.addons["pellicle"].preferences


# ---- the picture of docs/blender.md ----


def draw(path):
    """A cloth on a ball and a jelly that has fallen beside it, at the last frame."""
    scene = clear()
    scene.frame_end = 30
    plate = add("cylinder", "OBSTACLE", radius=0.5, depth=0.04, vertices=64, location=(0, 0, -0.02))
    ball = add("uv_sphere", "OBSTACLE", radius=0.16, segments=48, ring_count=32, location=(-0.14, 0, 0.16))
    cloth = add("grid", "BODY", "cloth", size=0.6, x_subdivisions=44, y_subdivisions=44, location=(-0.14, 0, 0.34))
    jelly = add("ico_sphere", "BODY", "jelly", subdivisions=4, radius=0.08, location=(0.3, -0.15, 0.14))
    assert bake(), messages()
    colours = {plate: (0.2, 0.21, 0.23), ball: (0.5, 0.5, 0.5), cloth: (0.03, 0.12, 0.35), jelly: (0.55, 0.06, 0.05)}
    for thing, colour in colours.items():
        material = bpy.data.materials.new(thing.name)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
        thing.data.materials.append(material)
        for polygon in thing.data.polygons:
            polygon.use_smooth = thing is not plate
    light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
    light.rotation_euler, light.data.energy, light.data.angle = (0.7, 0.2, 0.4), 2.2, 0.2
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.02, -1.35, 0.7), (1.14, 0, 0)
    for thing in light, camera:
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.55, 0.58, 0.62, 1)
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 48, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 800, 500, 100
    scene.view_settings.view_transform = "Standard"
    scene.frame_set(scene.frame_end)
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    bpy.ops.preferences.addon_enable(module="pellicle")
    preferences().program = arguments.program
    if arguments.picture:
        draw(os.path.abspath(arguments.picture))
        return
    failures = 0
    for name, test in [(name, value) for name, value in globals().items() if name.startswith("test_")]:
        try:
            test()
            print(f"ok      {name}")
        except Exception:
            traceback.print_exc()
            print(f"FAILED  {name}")
            failures += 1
    sys.exit(1 if failures else 0)


main()
