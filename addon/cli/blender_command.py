"""``blender --command aplanat``: the command line of an installed Aplanat."""

import bpy

from .command import run_in_blender

_handles = []


def register():
    """Make the command known to Blender."""
    _handles.append(bpy.utils.register_cli_command("aplanat", run_in_blender))


def unregister():
    """Undo `register`."""
    while _handles:
        bpy.utils.unregister_cli_command(_handles.pop())
