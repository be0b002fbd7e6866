"""Values of animated properties, kept while Blender renders.

A render evaluates the animation anew and leaves its values in the scene's data-blocks; what
somebody has changed and not yet keyed would be lost.
"""

import contextlib

import bpy


class KeptValues:
    """Gives animated properties their values back at the end of a `with` block."""

    def __enter__(self):
        """Note the values."""
        self._values = []
        for block in _animated_blocks():
            for path, index in sorted(_paths(block.animation_data)):
                with contextlib.suppress(ValueError, TypeError, IndexError):
                    self._values.append((block, path, index, _value(block, path, index)))
        return self

    def __exit__(self, *_):
        """Restore the values that changed."""
        changed = False
        for block, path, index, value in self._values:
            with contextlib.suppress(ValueError, TypeError, IndexError, ReferenceError):
                if _value(block, path, index) != value:
                    _set_value(block, path, index, value)
                    changed = True
        if changed:
            # What follows from them, such as matrices, is as it was, too.
            bpy.context.view_layer.update()


def _animated_blocks():
    for prop in bpy.types.BlendData.bl_rna.properties:
        if prop.type != "COLLECTION":
            continue
        for block in getattr(bpy.data, prop.identifier):
            # Linked data cannot be changed but by reading it again.
            if block.library is None and getattr(block, "animation_data", None) is not None:
                yield block


def _paths(animation):
    actions = [(animation.action, animation.action_slot)]
    for track in animation.nla_tracks:
        actions += [(strip.action, strip.action_slot) for strip in track.strips]
    found = set()
    for action, slot in actions:
        if action is None or slot is None:
            continue
        for layer in action.layers:
            for strip in layer.strips:
                bag = strip.channelbag(slot)
                found |= {(c.data_path, c.array_index) for c in (bag.fcurves if bag else ())}
    return found


def _value(block, path, index):
    value = block.path_resolve(path)
    return value[index] if _is_array(value) else value


def _set_value(block, path, index, value):
    current = block.path_resolve(path)
    if _is_array(current):
        current[index] = value
        return
    owner, _, name = path.rpartition(".")
    target = block.path_resolve(owner) if owner else block
    if name.endswith('"]'):
        target[name.split('"')[-2]] = value
    else:
        setattr(target, name, value)


def _is_array(value):
    return hasattr(value, "__getitem__") and not isinstance(value, str)
