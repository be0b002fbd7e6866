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


def wait(framebuffer):
    """Wait until the device has finished drawing into a frame buffer.

    Reading a pixel is the only way to wait that Blender offers.
    """
    with framebuffer.bind():
        framebuffer.read_color(0, 0, 1, 1, 4, 0, "FLOAT")
