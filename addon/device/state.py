"""Fixed-function state, set in whole named sets so that no pass inherits another's."""

from contextlib import contextmanager


@contextmanager
def preserved():
    """Restore Blender's own GPU state after a `with` block."""
    import gpu

    blend = gpu.state.blend_get()
    depth_test = gpu.state.depth_test_get()
    depth_mask = gpu.state.depth_mask_get()
    try:
        yield
    finally:
        gpu.state.blend_set(blend)
        gpu.state.depth_test_set(depth_test)
        gpu.state.depth_mask_set(depth_mask)
        gpu.state.face_culling_set("NONE")


@contextmanager
def confined(x, y, width, height):
    """Set the viewport to a rectangle of the bound frame buffer, in pixels, for a `with` block."""
    with viewport_kept():
        set_viewport(x, y, width, height)
        yield


@contextmanager
def viewport_kept():
    """Restore the viewport after a `with` block."""
    import gpu

    viewport = gpu.state.viewport_get()
    try:
        yield
    finally:
        gpu.state.viewport_set(*viewport)


def set_viewport(x, y, width, height):
    """Set the viewport to a rectangle of the bound frame buffer, in pixels; see `viewport_kept`."""
    import gpu

    gpu.state.viewport_set(x, y, width, height)


@contextmanager
def scissored(x, y, width, height):
    """Set the scissor rectangle of the bound frame buffer for a `with` block.

    Unlike with `confined`, rasterisation does not depend on the rectangle, to the last bit.
    """
    import gpu

    gpu.state.scissor_test_set(True)
    gpu.state.scissor_set(x, y, width, height)
    try:
        yield
    finally:
        gpu.state.scissor_test_set(False)


@contextmanager
def clipped(distances):
    """Enable the first clip distances of the vertex shader for a `with` block."""
    import gpu

    gpu.state.clip_distances_set(distances)
    try:
        yield
    finally:
        gpu.state.clip_distances_set(0)


def opaque():
    """Nearest surface wins: depth test and write, no blending."""
    import gpu

    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    gpu.state.face_culling_set("NONE")


def always():
    """Every fragment replaces colour and depth, whatever was there."""
    import gpu

    opaque()
    gpu.state.depth_test_set("ALWAYS")


def overwrite():
    """Every fragment replaces what was there; no depth."""
    import gpu

    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    gpu.state.depth_mask_set(False)
    gpu.state.face_culling_set("NONE")


def behind():
    """Draw where the depth buffer is empty; depth is kept."""
    import gpu

    opaque()
    gpu.state.depth_mask_set(False)


def marked():
    """Draw where the depth buffer has the very depth of what is drawn; depth is kept."""
    import gpu

    behind()
    gpu.state.depth_test_set("EQUAL")


def hidden():
    """Draw behind what is in the depth buffer; depth is kept."""
    import gpu

    opaque()
    gpu.state.depth_test_set("GREATER")
    gpu.state.depth_mask_set(False)


def farthest():
    """Farthest surface wins, in a depth buffer cleared to 0: depth test and write, no blending."""
    import gpu

    opaque()
    gpu.state.depth_test_set("GREATER")


def glow():
    """Add all four channels where the depth test passes; depth is kept."""
    import gpu

    behind()
    gpu.state.blend_set("ADDITIVE_PREMULT")


def filter_light():
    """Multiply all four channels where the depth test passes; depth is kept."""
    import gpu

    behind()
    gpu.state.blend_set("MULTIPLY")


def additive():
    """Add all four channels; no depth."""
    import gpu

    overwrite()
    # Blender's name for source one, destination one ("ADDITIVE" multiplies by alpha).
    gpu.state.blend_set("ADDITIVE_PREMULT")


def multiply():
    """Multiply the colour in the target by the new one; no depth."""
    import gpu

    overwrite()
    gpu.state.blend_set("MULTIPLY")


def over():
    """Alpha-blend premultiplied colour over the target; no depth."""
    import gpu

    overwrite()
    gpu.state.blend_set("ALPHA_PREMULT")


def veil():
    """Alpha-blend colour that is not premultiplied over the target; no depth."""
    import gpu

    overwrite()
    gpu.state.blend_set("ALPHA")
