"""The version of the stored settings, and what brings those of older files up to it.

A property is stored under its name, a choice as its number, and only what was ever set is stored.
So a file of an older Aplanat opens as it is as long as names and numbers stay. What can not stay
gets a new name, a new version, and a step here that moves what was stored.

The version stands in each scene, as the property `settings_version`, and is written when a file is
saved; 0 is Aplanat 0.1, which wrote none. Steps run after a file is opened, on its own data-blocks
and on those that it links; nothing is written where no step is due, so opening a file changes
nothing in it. Blender saves no version with an autosave of a scene that was never saved: a step
must leave alone what is stored as it wants it already.
"""

import bpy
from bpy.app.handlers import persistent

from ...engine.render_engine import ENGINE_ID

# What this Aplanat stores.
VERSION = 1

# By the version that it leads to: called as step(kind, stored) for each data-block that has stored
# settings. `kind` is the name of its collection in bpy.data, or "view_layers"; `stored` holds the
# stored values by name, groups inside as groups, and also those whose property is gone.
STEPS = {}

_COLLECTIONS = ("scenes", "cameras", "lights", "materials", "worlds")


def stored_settings(block):
    """Return what is stored of a data-block's settings, or None; nothing is made to exist.

    Parameters
    ----------
    block : bpy.types.ID or bpy.types.ViewLayer

    Returns
    -------
    bpy.types.PropertyGroup or None
        The values by name, as a dict holds them.
    """
    group = block.bl_system_properties_get()
    return group.get("aplanat") if group is not None else None


def _file_version():
    """Return the oldest version of the scenes of the open file; `VERSION` where none has any."""
    found = (stored_settings(scene) for scene in bpy.data.scenes if scene.library is None)
    return min((s.get("settings_version", 0) for s in found if s is not None), default=VERSION)


def _blocks():
    for kind in _COLLECTIONS:
        for block in getattr(bpy.data, kind):
            yield kind, block
    for scene in bpy.data.scenes:
        for layer in scene.view_layers:
            yield "view_layers", layer


@persistent
def migrate(*_):
    """Bring the settings of the open file up to `VERSION`."""
    due = [step for version, step in sorted(STEPS.items()) if version > _file_version()]
    if not due:
        return
    for kind, block in _blocks():
        stored = stored_settings(block)
        if stored is not None:
            for step in due:
                step(kind, stored)
    _stamp()


@persistent
def _stamp(*_):
    """Write the version into the scenes that have settings or are rendered by Aplanat."""
    for scene in bpy.data.scenes:
        ours = scene.render.engine == ENGINE_ID or stored_settings(scene) is not None
        if ours and scene.library is None and scene.aplanat.settings_version != VERSION:
            scene.aplanat.settings_version = VERSION


def register():
    """Look after the files that are opened and saved."""
    # Before the other handlers read settings.
    bpy.app.handlers.load_post.insert(0, migrate)
    bpy.app.handlers.save_pre.append(_stamp)


def unregister():
    """Undo `register`."""
    bpy.app.handlers.save_pre.remove(_stamp)
    bpy.app.handlers.load_post.remove(migrate)
