"""Read-back: from the device to numpy arrays."""

import numpy as np


def read_color(framebuffer, width, height, channels=4, slot=0):
    """Read a colour target of floats.

    Parameters
    ----------
    framebuffer : GPUFrameBuffer
    width, height : int
        In pixels.
    channels : int
    slot : int
        Which colour target of the frame buffer.

    Returns
    -------
    ndarray of shape (height, width, channels)
        float32, bottom row first.
    """
    import gpu

    pixels = np.empty((height, width, channels), np.float32)
    buffer = gpu.types.Buffer("FLOAT", pixels.shape, pixels)
    # Blender learns the size of a frame buffer when it is bound.
    with framebuffer.bind():
        framebuffer.read_color(0, 0, width, height, channels, slot, "FLOAT", data=buffer)
    return pixels


def read_depth():
    """Copy the depth of the bound frame buffer, within its viewport, into a texture.

    Returns
    -------
    texture : GPUTexture
        R32F.
    origin : tuple of 2 int
        Lower left corner of the viewport in the frame buffer, px.
    """
    import gpu

    x, y, width, height = gpu.state.viewport_get()
    pixels = gpu.state.active_framebuffer_get().read_depth(x, y, width, height)
    # A flat buffer is what a texture takes.
    pixels.dimensions = width * height
    return gpu.types.GPUTexture((width, height), format="R32F", data=pixels), (x, y)


def read_texel(texture, layer, x, y):
    """Read a texel of four channels of an array texture.

    Parameters
    ----------
    texture : GPUTexture
        An array, of a format that can be drawn into.
    layer, x, y : int

    Returns
    -------
    ndarray of float32, shape (4,)
    """
    import gpu

    slot = {"texture": texture, "layer": layer}
    framebuffer = gpu.types.GPUFrameBuffer(color_slots=slot)
    with framebuffer.bind():
        found = framebuffer.read_color(x, y, 1, 1, 4, 0, "FLOAT")
    return np.array(found, np.float32).reshape(4)


def wait(framebuffer):
    """Wait until the device has finished drawing into a frame buffer.

    Reading a pixel is the only way to wait that Blender offers.
    """
    with framebuffer.bind():
        framebuffer.read_color(0, 0, 1, 1, 4, 0, "FLOAT")
