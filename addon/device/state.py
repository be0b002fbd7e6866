"""Fixed-function state, set in whole named sets so that no pass inherits another's."""

from contextlib import contextmanager


@contextmanager
def preserved():
    """Give back Blender's own state after a `with` block that draws between its drawings."""
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
    """Draw into a rectangle of the bound frame buffer, in pixels, for a `with` block."""
    import gpu

    viewport = gpu.state.viewport_get()
    gpu.state.viewport_set(x, y, width, height)
    try:
        yield
    finally:
        gpu.state.viewport_set(*viewport)


@contextmanager
def scissored(x, y, width, height):
    """Leave everything outside a rectangle of the bound frame buffer as it is, for a `with` block.

    Unlike `confined`, where a point lands does not depend on the rectangle, to the last bit.
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
    """Cut off what the first clip distances of the vertex shader are negative for, in a block."""
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


def overwrite():
    """Every fragment replaces what was there; no depth."""
    import gpu

    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    gpu.state.depth_mask_set(False)
    gpu.state.face_culling_set("NONE")


def behind():
    """Fill what the depth buffer has left empty; depth is kept."""
    import gpu

    opaque()
    gpu.state.depth_mask_set(False)


def glow():
    """Sum of all four channels wherever nothing is in front; depth is kept."""
    import gpu

    behind()
    gpu.state.blend_set("ADDITIVE_PREMULT")


def additive():
    """Sum of all four channels; no depth."""
    import gpu

    overwrite()
    # Blender's name for source one, destination one ("ADDITIVE" multiplies by alpha).
    gpu.state.blend_set("ADDITIVE_PREMULT")


def multiply():
    """Product of the colour that is there and the new one; no depth."""
    import gpu

    overwrite()
    gpu.state.blend_set("MULTIPLY")


def over():
    """Lay premultiplied colour over what is there; no depth."""
    import gpu

    overwrite()
    gpu.state.blend_set("ALPHA_PREMULT")
