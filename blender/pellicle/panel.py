"""The tab Pellicle in the sidebar of the 3D viewport."""

import textwrap

import bpy

from . import operators, settings
from .export import OWN_NUMBERS


class PELLICLE_PT_object(bpy.types.Panel):
    bl_idname = "PELLICLE_PT_object"
    bl_label = "Object"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellicle"

    def draw(self, context):
        layout, thing = self.layout, context.object
        layout.use_property_split, layout.use_property_decorate = True, False
        if thing is None or thing.type != "MESH":
            layout.label(text="Select a mesh", icon="INFO")
            return
        own = thing.pellicle
        layout.prop(own, "role")
        if own.role == "BODY":
            draw_body(layout, thing, own)


def draw_body(layout, thing, own):
    layout.prop(own, "preset")
    layout.prop(own, "use_numbers")
    if own.use_numbers:
        layout.prop(own, "young")
        if own.preset != "tissue":
            layout.prop(own, "thickness")
        layout.prop(own, "density")
    layout.prop_search(own, "pin_group", thing, "vertex_groups")
    if own.preset in OWN_NUMBERS or own.use_numbers:
        layout.prop_search(own, "stiffness_group", thing, "vertex_groups")
        if own.stiffness_group:
            layout.prop(own, "stiffness_factor")
    if own.preset != "tissue":
        layout.prop_search(own, "muscle_group", thing, "vertex_groups")
        if own.muscle_group:
            layout.prop(own, "contraction")
    if own.preset == "balloon":
        layout.prop(own, "volume_ratio")
    if own.preset == "balloon" or (own.preset != "tissue" and own.muscle_group):
        layout.prop(own, "ramp")


class PELLICLE_PT_scene(bpy.types.Panel):
    bl_idname = "PELLICLE_PT_scene"
    bl_label = "Simulation"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellicle"

    def draw(self, context):
        layout, own = self.layout, context.scene.pellicle
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in "folder", "steps", "friction", "self_contact", "use_air":
            layout.prop(own, name)
        if own.use_air:
            layout.prop(own, "wind")
            layout.prop(own, "gusts")
        if settings.program_path(context) is None:
            layout.label(text="The program pellicle is not found", icon="ERROR")
        if operators.current is not None:
            row = layout.row()
            # the field shows a bar; it is not for typing
            row.enabled = False
            row.prop(own, "progress", slider=True)
            layout.operator("pellicle.cancel", icon="CANCEL")
        else:
            layout.operator("pellicle.bake", icon="PLAY")
        row = layout.row(align=True)
        row.operator("pellicle.clear")
        row.operator("pellicle.write")
        draw_messages(layout, own.messages, context.region.width if context.region else 300)


def draw_messages(layout, messages, width):
    for message in messages.splitlines():
        icon = "ERROR" if "error:" in message else "INFO"
        for i, line in enumerate(textwrap.wrap(message, max(24, width // 8))):
            layout.label(text=line, icon=icon if i == 0 else "BLANK1")


classes = (PELLICLE_PT_object, PELLICLE_PT_scene)


def register():
    for item in classes:
        bpy.utils.register_class(item)


def unregister():
    for item in reversed(classes):
        bpy.utils.unregister_class(item)
