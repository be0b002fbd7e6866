"""Image-based lighting: prefiltered diffuse and glossy maps of the world, made once an image.

All are octahedral maps of the image's mean over a lobe around each direction: glossy ones of a GGX
lobe seen along its axis (normal = view = mirrored direction), for each of a few roughnesses, and a
diffuse one of the cosine lobe. The glossy light is the split-sum approximation: the map times the
lobe's reflectance under white surroundings (`ggx_table`). The image's colour factor and rotation
are applied when the maps are read, so that changing them computes nothing.

References: Karis, SIGGRAPH 2013 course; Krivanek and Colbert, GPU Gems 3, chapter 20 (samples of a
lobe, each read from a level as coarse as the sample).
"""

from functools import cache

import numpy as np

from ...device import geometry, shader_source, state
from ...device.shaders import ShaderInfo, compile_shader
from ...device.targets import Targets, TargetSpec
from ...device.textures import texture_2d
from ...device.uniform_block import UniformStruct
from ...device.uniforms import uniform_buffer
from ...sampling.halton import halton
from ...sampling.highlights import amplify
from ...snapshot.surface_graph import LARGEST_RADIANCE

ENVIRONMENT_PARAMS = UniformStruct("shared/environment_params.glsl", "EnvironmentParams")

# Must agree with lib/surface/environment_lib.glsl. Level i is of roughness (i + 1) / LEVELS.
LEVELS = 8
TILE = 128
# Halvings of the image that the lobe's samples are read from.
_PYRAMID = 6
_LARGEST_SOURCE = 1024
# Diffuse light is smooth: it is summed up from so many cells, rows and columns.
_CELLS = (24, 48)

_PREFILTER = ShaderInfo(
    name="aplanat_environment",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/surface/environment_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=tuple(("FLOAT_2D", f"level_{i}_tx") for i in range(_PYRAMID))
    + tuple(("FLOAT_2D", f"moment_{axis}_tx") for axis in "xyz"),
)


def world_pixels(pixels, world):
    """Return the pixels of a world's image as they are shown, without its colour factor.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Scene linear.
    world : World

    Returns
    -------
    ndarray of shape (height, width, 3)
        Scene linear, float32, finite.
    """
    if not world.amplification:
        return pixels
    amplified = amplify(pixels, np.float32(world.amplification), world.luminance)
    return np.clip(amplified, -LARGEST_RADIANCE, LARGEST_RADIANCE).astype(np.float32)


def shrink(pixels, largest):
    """Average an image down until it is at most `largest` texels wide and high.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
    largest : int

    Returns
    -------
    ndarray of shape (h, w, 3)
    """
    while pixels.shape[1] > largest or pixels.shape[0] > largest:
        pixels = _halve(pixels)
    return pixels


def squared(pixels, least=1):
    """Interpolate more rows or columns into an image whose texels are far from square.

    Lobes are averaged over texels as if these were about square and lay in one direction: an image
    of one row would light only surfaces that face the horizon.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
    least : int
        Columns that the result has at least; half as many rows.

    Returns
    -------
    ndarray of shape (h, w, 3)
        The image itself where neither side is too short.
    """
    height, width = pixels.shape[:2]
    rows = max(height, width // 2, least // 2)
    columns = max(width, min(2 * height, _LARGEST_SOURCE), least)
    # Less than twice as long as they are wide are left alone: a step would blur them unevenly.
    if rows >= 2 * height:
        pixels = _interpolated(pixels, rows, 0, wraps=False)
    if columns >= 2 * width:
        pixels = _interpolated(pixels, columns, 1, wraps=True)
    return pixels


def _interpolated(pixels, count, axis, wraps):
    """Interpolate an axis linearly at `count` places; it repeats, or ends at the poles."""
    size = pixels.shape[axis]
    places = (np.arange(count) + 0.5) * (size / count) - 0.5
    low = np.floor(places).astype(int)
    share = (places - low).astype(np.float32)
    share = share[:, None, None] if axis == 0 else share[:, None]
    ends = [index % size if wraps else np.clip(index, 0, size - 1) for index in (low, low + 1)]
    first, second = (np.take(pixels, index, axis=axis) for index in ends)
    return first * (1.0 - share) + second * share


def _halve(pixels):
    height, width = pixels.shape[:2]
    # An odd last row or column is given to its neighbour; a single one stays.
    rows = np.linspace(0, height, max(height // 2, 1) + 1).round().astype(int)[:-1]
    columns = np.linspace(0, width, max(width // 2, 1) + 1).round().astype(int)[:-1]
    sums = np.add.reduceat(np.add.reduceat(pixels, rows, axis=0), columns, axis=1)
    counts = np.diff(np.append(rows, height))[:, None] * np.diff(np.append(columns, width))
    return (sums / counts[..., None]).astype(np.float32)


def light_moments(pixels):
    """Sum up an image's light, times the direction it comes from, in cells of the image.

    A surface that faces a whole cell gets the scalar product of its normal and the cell's moment:
    exactly, wherever in the cell the light is. A small sun counts where it is.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Scene linear; equirectangular, bottom row first.

    Returns
    -------
    ndarray of shape (3, rows, columns, 4)
        float32, radiance times sr, by component of the direction; the fourth channel is that of an
        even radiance of 1.
    """
    height, width = pixels.shape[:2]
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
    azimuth = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
    angle = np.cos(elevation)[:, None] * (np.pi / height) * (2.0 * np.pi / width)
    across = np.cos(elevation)[:, None]
    directions = (
        across * np.cos(azimuth),
        across * np.sin(azimuth),
        np.broadcast_to(np.sin(elevation)[:, None], (height, width)),
    )
    light = np.concatenate([pixels, np.ones((height, width, 1))], axis=-1) * angle[..., None]
    rows, columns = (
        np.linspace(0, size, min(size, most) + 1).round().astype(int)[:-1]
        for size, most in zip((height, width), _CELLS, strict=True)
    )
    return np.stack([
        np.add.reduceat(np.add.reduceat(light * part[..., None], rows), columns, axis=1)
        for part in directions
    ]).astype(np.float32)  # fmt: skip


# Memo of its arguments alone: the same table for every scene.
@cache
def ggx_table(size=32, samples=512):
    """Tabulate the reflectance of a GGX lobe under white surroundings (directional albedo).

    Parameters
    ----------
    size : int
        Rows of roughness from 0 to 1, columns of the square root of the cosine to the normal.
    samples : int
        A table entry.

    Returns
    -------
    ndarray of shape (size, size, 4)
        float32. For a reflectance f0 + (1 - f0) (1 - cos)^5: factor of f0 and of 1 in the first two
        channels; the third is the mean of their sum over the hemisphere, weighted by the cosine.

    References
    ----------
    Heitz, Sampling the GGX distribution of visible normals, JCGT 7(4), 2018.
    """
    cosine = np.maximum(np.linspace(0.0, 1.0, size) ** 2, 1e-4)[None, :, None]
    alpha = np.maximum(np.linspace(0.0, 1.0, size) ** 2, 1e-4)[:, None, None]
    u = halton(0, samples, (2, 3))
    view = np.stack(np.broadcast_arrays(np.sqrt(1 - cosine**2), 0.0 * cosine, cosine), axis=-1)
    stretched = view * np.stack(np.broadcast_arrays(alpha, alpha, 1.0 + 0 * alpha), axis=-1)
    stretched /= np.linalg.norm(stretched, axis=-1, keepdims=True)
    # The view has no y component, so the frame across it is simple.
    across = np.array([0.0, 1.0, 0.0])
    other = np.cross(stretched, across)
    radius, angle = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    t1 = radius * np.cos(angle)
    lift = 0.5 * (1.0 + stretched[..., 2])
    t2 = (1 - lift) * np.sqrt(1 - t1**2) + lift * (radius * np.sin(angle))
    t3 = np.sqrt(np.maximum(1 - t1**2 - t2**2, 0.0))
    half = t1[..., None] * across + t2[..., None] * other + t3[..., None] * stretched
    half = half * np.stack(np.broadcast_arrays(alpha, alpha, 1.0 + 0 * alpha), axis=-1)
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    dot = (view * half).sum(axis=-1)
    light_z = 2 * dot * half[..., 2] - cosine
    lit = light_z > 0.0
    z = np.where(lit, light_z, 1.0)
    smith_view = np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1))
    smith_light = np.sqrt(1 + alpha**2 * (1 / z**2 - 1))
    weight = np.where(lit, (1 + smith_view) / (smith_view + smith_light), 0.0)
    rise = np.clip(1 - dot, 0.0, 1.0) ** 5
    table = np.zeros((size, size, 4), np.float32)
    table[..., 0] = (weight * (1 - rise)).mean(axis=-1)
    table[..., 1] = (weight * rise).mean(axis=-1)
    total = (table[..., 0] + table[..., 1]).astype(np.float64)
    # Over cosines c = t^2: integral of 2 c E dc = integral of 4 t^3 E dt.
    t = np.linspace(0.0, 1.0, size)
    table[..., 2] = np.trapezoid(4 * t**3 * total, t, axis=1)[:, None]
    return table


def ggx_texture():
    """Upload `ggx_table`.

    Returns
    -------
    GPUTexture
    """
    texture = texture_2d(ggx_table())
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    return texture


def prefilter(pixels):
    """Prefilter an image: its glossy levels by roughness, and its diffuse light.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Scene linear.

    Returns
    -------
    GPUTexture
        `LEVELS` octahedral maps in a row, and one of the diffuse light.
    """
    level = squared(shrink(pixels, _LARGEST_SOURCE))
    moments = light_moments(squared(level, _CELLS[1]))
    textures = {
        f"moment_{axis}_tx": texture_2d(moment) for axis, moment in zip("xyz", moments, strict=True)
    }
    for i in range(_PYRAMID):
        textures[f"level_{i}_tx"] = _opaque_texture(level)
        level = _halve(level)
    targets = Targets(TILE * (LEVELS + 1), TILE, [TargetSpec("levels", "RGBA32F")])
    with targets.framebuffer("levels").bind():
        state.overwrite()
        shader = compile_shader(_PREFILTER)
        shader.bind()
        for name, texture in textures.items():
            shader.uniform_sampler(name, texture)
        shader.draw(geometry.fullscreen_batch())
    levels = targets["levels"]
    levels.filter_mode(True)
    levels.extend_mode("EXTEND")
    return levels


def _opaque_texture(pixels):
    opaque = np.ones((*pixels.shape[:2], 1), np.float32)
    return texture_2d(np.concatenate([pixels, opaque], axis=2))


def environment_buffer(world):
    """Upload the block that lit surfaces and the background read.

    Parameters
    ----------
    world : World

    Returns
    -------
    GPUUniformBuf
    """
    rows = [(*row, 0.0) for row in world.rotation]
    return uniform_buffer(
        ENVIRONMENT_PARAMS.pack(
            rotation_x=rows[0],
            rotation_y=rows[1],
            rotation_z=rows[2],
            color=(*world.color, float(world.image != 0)),
        )
    )


def single_texel():
    """Return a texture of one texel, for samplers that are not read where a world has no image."""
    return texture_2d(np.zeros((1, 1, 4), np.float32))
