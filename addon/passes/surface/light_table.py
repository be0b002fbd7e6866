"""The lights of a scene and the light samples of a frame as a texture.

The first row says how many lights there are (x), in which row the light samples begin (y), and in
which the tables of the sky (z). Then a row a light (``lib/surface/light_lib.glsl``), a row a light
sample (``lib/surface/light_map_lib.glsl``), and for the two sequences of light samples what
`Sky.corrections` gives.
"""

import numpy as np

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
        float32.
    """
    texels = np.zeros((len(lights), _TEXELS, 4), np.float32)
    for row, light in zip(texels, lights, strict=False):
        row[0] = (*light.position, KINDS[light.kind])
        row[1] = (*light.radiance, light.radius)
        row[2] = (*light.direction, light.soft_falloff + 2.0 * (not light.highlights))
        row[3] = (light.diffuse_factor, light.specular_factor, *light.cone)
        row[4] = (*light.axes[0], light.half_size[0])
        row[5] = (*light.axes[1], light.half_size[1])
        row[6] = (*light.axes[2], 0.0)
    return texels


def table_texels(lights, samples, skies=()):
    """Lay out lights and light samples.

    Parameters
    ----------
    lights : sequence of Light
    samples : ndarray of shape (M, R, 4)
        Rows of light samples.
    skies : sequence of ndarray of shape (n, n)
        Tables of the sky.

    Returns
    -------
    ndarray of shape (rows, columns, 4)
        float32.
    """
    rows = light_texels(lights)
    tables = [np.asarray(sky, np.float32)[..., None] for sky in skies]
    parts = [part for part in (rows, samples, *tables) if len(part)]
    columns = max((part.shape[1] for part in parts), default=1)
    table = np.zeros((1 + sum(map(len, parts)), columns, 4), np.float32)
    table[0, 0, :3] = len(rows), 1 + len(rows), 1 + len(rows) + len(samples)
    place = 1
    for part in parts:
        table[place : place + len(part), : part.shape[1], : part.shape[2]] = part
        place += len(part)
    return table
