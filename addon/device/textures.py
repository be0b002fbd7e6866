"""Textures made from arrays."""

from collections import OrderedDict

import numpy as np

from . import census


def texture_2d(array, texel_format="RGBA32F"):
    """Upload an array as a 2D texture.

    Parameters
    ----------
    array : ndarray of shape (height, width, channels)
        float32; converted by the device to `texel_format`.
    texel_format : str

    Returns
    -------
    GPUTexture
    """
    import gpu

    data = np.ascontiguousarray(array, np.float32)
    height, width = data.shape[:2]
    buffer = gpu.types.Buffer("FLOAT", data.size, data.reshape(-1))
    texture = gpu.types.GPUTexture((width, height), format=texel_format, data=buffer)
    return census.record("texture", texture, census.texture_bytes(width, height, texel_format))


def texture_array(array, texel_format="RGBA32F"):
    """Upload an array as the layers of a 2D array texture.

    Parameters
    ----------
    array : ndarray of shape (layers, height, width, channels)
        float32; converted by the device to `texel_format`.
    texel_format : str

    Returns
    -------
    GPUTexture
        Linear filtering, ending at its edges.
    """
    import gpu

    data = np.ascontiguousarray(array, np.float32)
    layers, height, width = data.shape[:3]
    buffer = gpu.types.Buffer("FLOAT", data.size, data.reshape(-1))
    texture = gpu.types.GPUTexture((width, height), layers=layers, format=texel_format, data=buffer)
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    size = census.texture_bytes(width, height, texel_format, layers)
    return census.record("texture", texture, size)


def image_texture(image):
    """Upload an `ImageSnapshot`; 8-bit pixels stay encoded.

    Returns
    -------
    GPUTexture
        Linear filtering, repeating.
    """
    pixels = image.pixels
    if pixels.dtype == np.uint8:
        texture = texture_2d(pixels.astype(np.float32) / 255.0, "RGBA8")
    else:
        texture = texture_2d(pixels, "RGBA32F")
    texture.filter_mode(True)
    texture.extend_mode("REPEAT")
    return texture


class TextureCache:
    """Textures by the arrays that they are made from; the least recently used one is dropped.

    Arrays are compared by identity, and must not change.

    Parameters
    ----------
    most : int
        Largest number of textures.
    """

    def __init__(self, most=16):
        self._most = most
        # The array is kept with its texture, so that no other array gets its identity.
        self._kept = OrderedDict()

    def texture(self, array, make):
        """Return the texture of an array.

        Parameters
        ----------
        array : ndarray
        make : callable
            Returns the texture of an array; the same function for all arrays of a cache.

        Returns
        -------
        GPUTexture
        """
        key = id(array)
        if key not in self._kept:
            self._kept[key] = (array, make(array))
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key][1]

    def clear(self):
        """Drop all textures."""
        self._kept.clear()
