"""Aplanat's code. Importing it needs no Blender; `register` imports the Blender-facing modules."""


def register():
    """Register the engine, the user interface and the command with Blender."""
    from . import registration

    registration.register()


def unregister():
    """Undo `register`, in the reverse order."""
    from . import registration

    registration.unregister()
