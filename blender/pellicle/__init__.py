"""Pellicle in Blender: objects become bodies and obstacles, the program `pellicle` simulates them, and the result comes back as point
caches that keep UVs, materials and modifiers. docs/blender.md is the guide."""

bl_info = {
    "name": "Pellicle",
    "description": "Soft tissue, thin shells and cloth with contact",
    "author": "The Pellicle authors",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > Pellicle",
    "category": "Physics",
}

from . import operators, panel, settings

modules = (settings, operators, panel)


def register():
    for module in modules:
        module.register()


def unregister():
    for module in reversed(modules):
        module.unregister()
