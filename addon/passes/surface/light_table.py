"""The lights of a scene and the light samples of a frame as a texture, and lists of them.

The first row says how many lights there are (x), and in which row the light samples begin (y). Then
a row a light (``lib/surface/light_lib.glsl``), and a row a light sample
(``lib/surface/light_map_lib.glsl``).
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


def table_texels(lights, samples):
    """Lay out lights and light samples.

    Parameters
    ----------
    lights : sequence of Light
    samples : ndarray of shape (M, R, 4)
        Rows of light samples.

    Returns
    -------
    ndarray of shape (rows, columns, 4)
        float32.
    """
    parts = [part for part in (light_texels(lights), samples) if len(part)]
    columns = max((part.shape[1] for part in parts), default=1)
    table = np.zeros((1 + sum(map(len, parts)), columns, 4), np.float32)
    table[0, 0, :2] = len(lights), 1 + len(lights)
    place = 1
    for part in parts:
        table[place : place + len(part), : part.shape[1]] = part
        place += len(part)
    return table


def list_texels(lists):
    """Lay out what a drawing is lit from, a list a row.

    Parameters
    ----------
    lists : sequence of sampling.lights.light_turns.LightList

    Returns
    -------
    ndarray of shape (rows, columns, 4)
        float32. A texel a light, the sky last: in which column its places begin, how many there
        are, and its weight; then a texel a place: its row among the light samples.
    """
    lights = len(lists[0].counts)
    columns = lights + max(len(each.places) for each in lists)
    texels = np.zeros((len(lists), columns, 4), np.float32)
    for row, each in zip(texels, lists, strict=True):
        row[:lights, 0] = lights + each.firsts
        row[:lights, 1] = each.counts
        row[:lights, 2] = each.weights
        row[lights : lights + len(each.places), 0] = each.places
    return texels
