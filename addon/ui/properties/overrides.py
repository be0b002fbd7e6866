"""Library overrides of Aplanat's settings: kept through saving and loading.

Blender stores a property group with its first use. Where the library's data-block has none yet,
Blender notes as the difference that the whole group is another one, and cannot apply that when the
file is opened: all settings are lost. So the groups of the data-block in the library are made to
exist before Blender compares, whenever a setting of an override changes and before a file is saved;
then the difference is each setting that was changed.
"""

import bpy
from bpy.app.handlers import persistent

OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}

_COLLECTIONS = ("cameras", "lights", "materials", "worlds")


def setting_changed(settings, _context):
    """Answer a change of a setting: the `update` of a property.

    Parameters
    ----------
    settings : bpy.types.PropertyGroup
    """
    block = settings.id_data
    _keep_override(block)
    # Without this Blender evaluates the data-block again only if its windows made the change.
    block.update_tag()


# What the properties of a data-block that can be overridden have in common.
SHARED = {"override": OVERRIDABLE, "update": setting_changed}


def make_groups(group):
    """Make a property group and the groups inside it exist.

    Parameters
    ----------
    group : bpy.types.PropertyGroup
    """
    for name, kind in group.bl_rna.properties.items():
        # Its own description counts as a group, too.
        if kind.type != "POINTER" or name == "rna_type":
            continue
        inner = getattr(group, name)
        if isinstance(inner, bpy.types.PropertyGroup):
            make_groups(inner)


def _keep_override(block):
    override = block.override_library
    if override is not None and override.reference is not None:
        make_groups(override.reference.aplanat)


@persistent
def _keep_all_overrides(*_):
    for name in _COLLECTIONS:
        for block in getattr(bpy.data, name):
            _keep_override(block)


def register():
    """Keep the overrides of files that are opened and saved."""
    bpy.app.handlers.load_post.append(_keep_all_overrides)
    bpy.app.handlers.save_pre.append(_keep_all_overrides)


def unregister():
    """Undo `register`."""
    bpy.app.handlers.save_pre.remove(_keep_all_overrides)
    bpy.app.handlers.load_post.remove(_keep_all_overrides)
