"""The disc of a camera's lens as an image of the current file: square, float, scene linear.

The image is what Blender's nodes Bokeh Blur and Convolve take: both divide by the sum of its
values, channel by channel, so that only their ratios count; the brightest is 1. Alpha is the disc,
too: the nodes blur alpha with it.
"""

import math

import bpy
import numpy as np

from ..engine.bokeh.lens_sprite import SpritePoint, lens_sprite
from ..engine.shared_resources import real_lens_of, resources
from ..errors import InputError
from ..scene.camera.bokeh import corner_tangent, describe_bokeh
from ..scene.camera.camera import evaluated_camera, focus_distance
from .node_groups import SPRITE, is_ours, new_group

LEAST, MOST = 8, 2048
# Of the focus distance: a point in front of it.
_NEARER = 0.5


def camera_sprite(depsgraph, camera, field=(0.0, 0.0), behind=True, size=256):
    """Compose the sprite of a scene's camera.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object
    field : tuple of 2 float
        Place in the picture: (0, 0) is the middle, (1, 1) the upper right corner.
    behind : bool
        A point at infinity; else one at half the focus distance.
    size : int
        Pixels along a side.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Bottom row first; the brightest is 1.

    Raises
    ------
    InputError
        If the lens makes no disc there.
    """
    scene = depsgraph.scene
    seen = evaluated_camera(depsgraph, camera)
    data = seen.data
    corner = corner_tangent(data, scene)
    real_lens = real_lens_of(data)
    bokeh, _ = describe_bokeh(data, real_lens, corner, resources().panels.sources.irises)
    focus = focus_distance(depsgraph, seen)
    if not 0.0 < focus < math.inf:
        raise InputError(
            f"camera '{camera.name}' has no focus distance that makes a disc; set Depth of Field >"
            " Focus Distance"
        )
    render = scene.render
    width = render.resolution_x * render.pixel_aspect_x
    height = render.resolution_y * render.pixel_aspect_y
    scale = corner / math.hypot(width, height)
    tangent = field[0] * width * scale, field[1] * height * scale
    point = SpritePoint(tangent, math.inf if behind else _NEARER * focus, focus)
    return lens_sprite(bokeh, real_lens, point, size)


def store_sprite(name, light):
    """Put a sprite into an image of the current file, packed into it.

    Parameters
    ----------
    name : str
        Of the image; one of this name that is ours is drawn anew.
    light : ndarray of shape (size, size)

    Returns
    -------
    bpy.types.Image
    """
    size = len(light)
    image = bpy.data.images.get(name)
    if image is None or not image.get("aplanat_sprite") or image.library is not None:
        image = bpy.data.images.new(name, size, size, alpha=True, float_buffer=True, is_data=True)
        image["aplanat_sprite"] = True
        # Values are what they are: no channel is multiplied by alpha.
        image.alpha_mode = "CHANNEL_PACKED"
    elif tuple(image.size) != (size, size):
        image.scale(size, size)
    pixels = np.repeat(np.asarray(light, np.float32)[..., None], 4, axis=-1)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def fill_empty_groups(image):
    """Give an image to the sprite's groups that have none, as they come from the asset browser."""
    for tree in bpy.data.node_groups:
        if is_ours(tree, SPRITE) and tree.library is None:
            for node in tree.nodes:
                if node.type == "IMAGE" and node.image is None:
                    node.image = image


def sprite_group(image):
    """Return the node group that gives an image to Blender's nodes; it is made if there is none."""
    for tree in bpy.data.node_groups:
        if is_ours(tree, SPRITE) and tree.library is None:
            node = next((n for n in tree.nodes if n.type == "IMAGE"), None)
            if node is not None and node.image in (None, image):
                node.image = image
                return tree
    tree = new_group(SPRITE)
    next(node for node in tree.nodes if node.type == "IMAGE").image = image
    return tree
