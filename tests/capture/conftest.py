"""A small scene without noise, its capture, and all of Blender's data as text."""

import numpy as np
import pytest

from addon.layers.render_picture import read_render
from benchmarks.scenes.capture_scene import build

# What warns, what is told elsewhere, and how arrays happen to lie in memory.
_NOT_ASKED = {"rna_type", "original", "users", "use_nodes", "depsgraph", "all_ids", "storage_type"}


@pytest.fixture
def slope(aplanat_bpy):
    return build(aplanat_bpy, blocks=False)


@pytest.fixture
def blocks(aplanat_bpy):
    return build(aplanat_bpy)


@pytest.fixture
def capture(aplanat_bpy, tmp_path):
    """Capture a frame of a scene: `capture(scene, frame, layers=4, overscan=0.0, ...)`."""
    from addon.capture.frame_capture import FrameCapture, render_now
    from addon.capture.settings import CaptureSettings

    def run(scene, frame=1, **settings):
        chosen = {"layers": 4, "overscan": 0.0, "engine": scene.render.engine} | settings
        with FrameCapture(scene, frame, CaptureSettings(**chosen), tmp_path) as captured:
            steps = captured.steps()
            while True:
                try:
                    render_now(next(steps))
                except StopIteration as stop:
                    return stop.value

    return run


@pytest.fixture
def picture(aplanat_bpy, tmp_path):
    """Render a scene as it is; shape (height, width, 4), rows from the bottom."""

    def run(scene):
        scene.camera.data.dof.use_dof = False
        scene.view_layers[0].use_pass_z = True
        image = scene.render.image_settings
        image.media_type = "MULTI_LAYER_IMAGE"
        image.file_format = "OPEN_EXR_MULTILAYER"
        image.color_depth = "32"
        scene.render.filepath = str(tmp_path / "picture.exr")
        aplanat_bpy.ops.render.render(write_still=True)
        return read_render(tmp_path / "picture.exr", scene.view_layers[0].name).color

    return run


def laid_over(stack):
    """Return layers laid over each other, without the overscan."""
    total = np.zeros_like(stack.layers[0].color)
    for layer in reversed(stack.layers):
        total = layer.color + (1.0 - layer.color[..., 3:]) * total
    left, below = stack.overscan
    return total[below : below + stack.height, left : left + stack.width]


def all_data(bpy):
    """Return every value of every data-block, by its path."""
    found = {}
    for prop in bpy.types.BlendData.bl_rna.properties:
        if prop.type != "COLLECTION":
            continue
        for block in getattr(bpy.data, prop.identifier):
            path = f"{prop.identifier}[{block.name_full}]"
            found[f"{path}.users"] = block.users
            _dump(block, path, found, 0)
    return found


def _dump(struct, path, found, depth):
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in _NOT_ASKED or depth > 5:
            continue
        try:
            value = getattr(struct, name)
        except (AttributeError, ValueError, TypeError):
            continue
        here = f"{path}.{name}"
        if prop.type == "COLLECTION":
            found[f"{here}.len"] = len(value)
            for number, item in enumerate(value):
                if number < 64 and item is not None:
                    _visit(item, f"{here}[{number}]", found, depth)
        elif prop.type == "POINTER":
            _visit(value, here, found, depth)
        elif getattr(prop, "is_array", False):
            found[here] = str([*value] if hasattr(value, "__iter__") else value)
        else:
            found[here] = str(value)


def _visit(value, path, found, depth):
    if value is None:
        found[path] = None
    elif hasattr(value, "name_full"):
        # A data-block of its own, or one that another owns, such as a node tree.
        found[path] = value.name_full
        if getattr(value, "is_embedded_data", False):
            _dump(value, path, found, depth + 1)
    else:
        _dump(value, path, found, depth + 1)
