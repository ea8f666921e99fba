"""What the user sets: the preferences, and the properties of scenes and objects."""

import shutil

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty, StringProperty

ROLES = (
    ("NONE", "None", "Not part of the simulation"),
    ("BODY", "Body", "Deforms"),
    ("OBSTACLE", "Obstacle", "Moves by its own animation and pushes bodies"),
)

# identifier, name, description; from `skin` on these are materials of `pellicle presets`
PRESETS = (
    ("tissue", "Organ", "Soft tissue under a capsule; springs hold it at its place, as organs are held"),
    ("jelly", "Jelly", "A closed surface filled with water: falls, rolls and keeps its volume"),
    ("balloon", "Balloon", "A closed latex skin that is inflated"),
    ("cloth", "Cloth", "Woven cotton of 150 g/m2"),
    ("skin", "Skin", "Skin of the forearm"),
    ("lens-capsule", "Lens capsule", "Capsule of the human eye lens"),
    ("rubber", "Rubber", "Rubber sheet of 1 mm"),
    ("silicone", "Silicone", "Very soft silicone rubber of 2 mm"),
    ("paper", "Paper", "Office paper of 80 g/m2"),
    ("polyester-film", "Polyester film", "Film of 23 um"),
    ("aluminium-foil", "Aluminium foil", "Household foil of 16 um, elastic only"),
    ("steel-sheet", "Steel sheet", "Half a millimetre of steel"),
)


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(
        name="Program", description="The program pellicle; empty: the one on the path", subtype="FILE_PATH"
    )

    def draw(self, context):
        self.layout.prop(self, "program")
        found = program_path(context)
        self.layout.label(text=found or "not found: install Pellicle, or name the program", icon="CHECKMARK" if found else "ERROR")


def program_path(context):
    """The path of the program, or None."""
    addon = context.preferences.addons.get(__package__)
    named = addon.preferences.program if addon else ""
    return shutil.which(bpy.path.abspath(named)) if named else shutil.which("pellicle")


class ObjectSettings(bpy.types.PropertyGroup):
    role: EnumProperty(name="Role", items=ROLES, default="NONE")
    preset: EnumProperty(name="Preset", items=PRESETS, default="tissue")
    use_numbers: BoolProperty(name="Own numbers", description="Replace numbers of the preset")
    young: FloatProperty(
        name="Young's modulus", description="Pa; of tissue the filling, the capsule has ten times as much", default=5000, min=1, soft_max=1e9
    )
    thickness: FloatProperty(name="Thickness", description="mm, of sheets", default=1, min=0.001, soft_max=100)
    density: FloatProperty(name="Density", description="kg/m3", default=1000, min=0.1, soft_max=10000)
    pin_group: StringProperty(name="Pin", description="Vertex group that does not move, where its weight exceeds 0.5")
    stiffness_group: StringProperty(name="Stiffness", description="Vertex group that multiplies Young's modulus")
    stiffness_factor: FloatProperty(
        name="Factor", description="Young's modulus at weight 1, relative to that at weight 0", default=5, min=0.001, soft_max=100
    )
    muscle_group: StringProperty(name="Muscle", description="Vertex group with fibres that contract, where its weight exceeds 0.5 (sheets)")
    contraction: FloatProperty(name="Contraction", description="Shortening of the fibres", default=0.3, min=0, max=0.9, subtype="FACTOR")
    volume_ratio: FloatProperty(name="Volume", description="Volume at the end, relative to that at rest (balloon)", default=3, min=0.1, soft_max=20)
    ramp: FloatProperty(name="Within", description="s from the first frame in which volume and contraction grow", default=1, min=0.01, soft_max=10)


class SceneSettings(bpy.types.PropertyGroup):
    folder: StringProperty(name="Folder", description="Scene, results and caches", default="//pellicle", subtype="DIR_PATH")
    steps: IntProperty(name="Steps per frame", description="More steps resolve faster motion", default=4, min=1, soft_max=50)
    friction: FloatProperty(name="Friction", description="Coulomb's coefficient", default=0.3, min=0, soft_max=1)
    use_air: BoolProperty(name="Air", description="Drag and lift of the air on every triangle", default=False)
    wind: FloatVectorProperty(name="Wind", description="m/s", size=3, default=(0, 0, 0), subtype="VELOCITY")
    gusts: FloatProperty(name="Gusts", description="m/s, added to the wind and changing in space and time", default=0, min=0, soft_max=10)
    self_contact: BoolProperty(name="Self-contact", description="Parts of one body touch each other", default=True)
    progress: FloatProperty(name="Progress", default=-1, min=-1, max=1, options={"SKIP_SAVE"})
    messages: StringProperty(name="Messages", description="One message a line", options={"SKIP_SAVE"})


classes = (Preferences, ObjectSettings, SceneSettings)


def register():
    for item in classes:
        bpy.utils.register_class(item)
    bpy.types.Object.pellicle = PointerProperty(type=ObjectSettings)
    bpy.types.Scene.pellicle = PointerProperty(type=SceneSettings)


def unregister():
    del bpy.types.Scene.pellicle
    del bpy.types.Object.pellicle
    for item in reversed(classes):
        bpy.utils.unregister_class(item)
