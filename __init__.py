"""Aplanat: a camera lens for Blender. The file Blender loads beside the manifest."""

# Test runners import this file without a package; Blender always gives it one.
if __package__:
    from .addon import register, unregister

    __all__ = ["register", "unregister"]
