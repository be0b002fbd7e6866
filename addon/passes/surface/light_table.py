"""The lights of a scene as a texture, one row a light (`lib/surface/light_lib.glsl`)."""

import numpy as np

from ...device.textures import texture_2d

KINDS = {"SUN": 1, "POINT": 2, "SPOT": 3, "AREA": 4}
_TEXELS = 7


def light_texels(lights):
    """Lay out lights as `light_fetch` reads them.

    Parameters
    ----------
    lights : sequence of Light

    Returns
    -------
    ndarray of shape (rows, 7, 4)
        float32; one unlit row where there are no lights.
    """
    texels = np.zeros((max(1, len(lights)), _TEXELS, 4), np.float32)
    for row, light in zip(texels, lights, strict=False):
        row[0] = (*light.position, KINDS[light.kind])
        row[1] = (*light.radiance, light.radius)
        row[2] = (*light.direction, light.soft_falloff + 2.0 * (not light.highlights))
        row[3] = (light.diffuse_factor, light.specular_factor, *light.cone)
        row[4] = (*light.axes[0], light.half_size[0])
        row[5] = (*light.axes[1], light.half_size[1])
        row[6] = (*light.axes[2], 0.0)
    return texels


def light_texture(lights):
    """Upload lights.

    Returns
    -------
    GPUTexture
    """
    return texture_2d(light_texels(lights))
