"""The world as a light: diffuse and glossy light of an equirectangular image, made once an image.

Diffuse light is kept as spherical harmonics up to order 2, which hold the light of a Lambertian
surface to about a percent; glossy light as octahedral maps, one for each of a few roughnesses, of
the image's mean over a GGX lobe seen along its axis (normal, view and mirrored direction alike).
Multiplied by what the lobe reflects of white surroundings this is the split sum. The image's colour
factor and rotation are applied when it is read, so that changing them computes nothing.

References: Ramamoorthi and Hanrahan, SIGGRAPH 2001; Karis, SIGGRAPH 2013 course; Krivanek and
Colbert, GPU Gems 3, chapter 20 (samples of a lobe, each read from a level as coarse as the sample).
"""

from functools import cache

import numpy as np

from ..device import geometry, shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from ..device.targets import Targets, TargetSpec
from ..device.textures import texture_2d
from ..device.uniform_block import UniformStruct
from ..device.uniforms import uniform_buffer
from ..sampling.halton import halton

ENVIRONMENT_PARAMS = UniformStruct("shared/environment_params.glsl", "EnvironmentParams")

# Must agree with lib/environment_lib.glsl. Level i is of roughness (i + 1) / LEVELS.
LEVELS = 8
TILE = 128
# Halvings of the image that the lobe's samples are read from.
_PYRAMID = 6
_LARGEST_SOURCE = 1024

_PREFILTER = ShaderInfo(
    name="aplanat_environment",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/environment_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=tuple(("FLOAT_2D", f"level_{i}_tx") for i in range(_PYRAMID)),
)


def linear_pixels(image):
    """Return an image's pixels scene linear, shape (height, width, 3), float32."""
    if image.pixels.dtype != np.uint8:
        return np.ascontiguousarray(image.pixels[..., :3], np.float32)
    encoded = np.arange(256, dtype=np.float64) / 255.0
    if image.srgb:
        high = ((encoded + 0.055) / 1.055) ** 2.4
        encoded = np.where(encoded < 0.04045, encoded / 12.92, high)
    return np.take(encoded.astype(np.float32), image.pixels[..., :3])


def direction_grid(width, height):
    """Return the directions of an equirectangular image's texels and their solid angles.

    Parameters
    ----------
    width, height : int

    Returns
    -------
    directions : ndarray of shape (height, width, 3)
        Blender's convention: +x in the middle, z up; bottom row first.
    solid_angles : ndarray of shape (height, 1)
        In sr; they add up to 4 pi over the image.
    """
    longitude = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
    edges = (np.arange(height + 1) / height - 0.5) * np.pi
    latitude = (edges[1:] + edges[:-1]) / 2
    directions = np.empty((height, width, 3))
    directions[..., 0] = np.cos(latitude)[:, None] * np.cos(longitude)
    directions[..., 1] = np.cos(latitude)[:, None] * np.sin(longitude)
    directions[..., 2] = np.sin(latitude)[:, None]
    solid_angles = (np.sin(edges[1:]) - np.sin(edges[:-1])) * (2.0 * np.pi / width)
    return directions, solid_angles[:, None]


def shrink(pixels, largest):
    """Average an image down until it is at most `largest` texels wide.

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


def _halve(pixels):
    height, width = pixels.shape[:2]
    if height < 2 or width < 2:
        return pixels
    # An odd last row or column is given to its neighbour.
    rows = np.linspace(0, height, height // 2 + 1).round().astype(int)[:-1]
    columns = np.linspace(0, width, width // 2 + 1).round().astype(int)[:-1]
    sums = np.add.reduceat(np.add.reduceat(pixels, rows, axis=0), columns, axis=1)
    counts = np.diff(np.append(rows, height))[:, None] * np.diff(np.append(columns, width))
    return (sums / counts[..., None]).astype(np.float32)


def diffuse_harmonics(pixels):
    """Project an image on the harmonics that `environment_diffuse` evaluates.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Scene linear.

    Returns
    -------
    ndarray of shape (9, 3)
        Coefficients of the polynomials 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2; the cosine lobe
        over pi is included, so a constant image gives its own colour.
    """
    directions, solid_angles = direction_grid(pixels.shape[1], pixels.shape[0])
    x, y, z = (directions[..., i] for i in range(3))
    polynomials = np.stack(
        [np.ones_like(x), y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]
    )
    # Squared normalisation of each real harmonic, times the lobe's 1, 2/3, 1/4.
    c0, c1, c2 = 1 / (4 * np.pi), 3 / (4 * np.pi), 15 / (4 * np.pi)
    scale = [c0, *[c1 * 2 / 3] * 3, c2 / 4, c2 / 4, 5 / (16 * np.pi) / 4, c2 / 4, c2 / 16]
    weighted = pixels.astype(np.float64) * solid_angles[..., None]
    return np.einsum("khw,hwc->kc", polynomials, weighted) * np.array(scale)[:, None]


@cache
def ggx_table(size=32, samples=512):
    """Tabulate what a GGX lobe reflects of white surroundings.

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
    """Make the glossy levels of an image.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Scene linear.

    Returns
    -------
    GPUTexture
        `LEVELS` octahedral maps in a row.
    """
    level = shrink(pixels, _LARGEST_SOURCE)
    textures = []
    for _ in range(_PYRAMID):
        padded = np.concatenate([level, np.ones((*level.shape[:2], 1), np.float32)], axis=2)
        textures.append(texture_2d(padded))
        level = _halve(level)
    targets = Targets(TILE * LEVELS, TILE, [TargetSpec("levels", "RGBA16F")])
    with targets.framebuffer("levels").bind():
        state.overwrite()
        shader = compile_shader(_PREFILTER)
        shader.bind()
        for i, texture in enumerate(textures):
            shader.uniform_sampler(f"level_{i}_tx", texture)
        geometry.fullscreen_batch().draw(shader)
    levels = targets["levels"]
    levels.filter_mode(True)
    levels.extend_mode("EXTEND")
    return levels


def environment_buffer(world, harmonics):
    """Upload the block that lit surfaces and the background read.

    Parameters
    ----------
    world : World
    harmonics : ndarray of shape (9, 3) or None
        Of the world's image; None without one.

    Returns
    -------
    GPUUniformBuf
    """
    coefficients = np.zeros((9, 4))
    if harmonics is not None:
        coefficients[:, :3] = harmonics
    rows = [(*row, 0.0) for row in world.rotation]
    return uniform_buffer(
        ENVIRONMENT_PARAMS.pack(
            harmonics=coefficients,
            rotation_x=rows[0],
            rotation_y=rows[1],
            rotation_z=rows[2],
            color=(*world.color, float(harmonics is not None)),
        )
    )


def single_texel():
    """Return a texture for samplers that a world without image leaves unread."""
    return texture_2d(np.zeros((1, 1, 4), np.float32))
