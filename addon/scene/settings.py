"""Render settings of a scene to `Film` and `Sampling`."""

import itertools
from dataclasses import replace

import numpy as np

from ..errors import InputError
from ..settings.scene_settings import (
    ADVANCED,
    LEVELS,
    LIGHT,
    MEASURING,
    PASSES,
    PREVIEW,
    RENDER,
    SAMPLING,
)
from ..settings.setting import fields_of
from ..snapshot import render_passes
from ..snapshot.film import Film, Sampling

# 16384 squared: the largest texture of today's graphics devices; 4 GB a target.
MAX_PIXELS = 2**28

# In pixels, of Cycles' own filter setting.
_LEAST_FILTER_SIZE = 0.01


def read_film(scene):
    """Return the raster of a scene's final render, rounded as Blender does.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    Film

    Raises
    ------
    InputError
        If the picture or its render region has no pixels, or more than `MAX_PIXELS`.
    """
    render = scene.render
    width = render.resolution_x * render.resolution_percentage // 100
    height = render.resolution_y * render.resolution_percentage // 100
    if width < 1 or height < 1:
        raise InputError(
            f"scene '{scene.name}': {render.resolution_percentage} % of {render.resolution_x} x"
            f" {render.resolution_y} pixels is less than one; raise the resolution or its scale"
        )
    region = (0, 0, width, height)
    if render.use_border:
        x0, x1 = _pixel(render.border_min_x, width), _pixel(render.border_max_x, width)
        y0, y1 = _pixel(render.border_min_y, height), _pixel(render.border_max_y, height)
        region = (x0, y0, x1 - x0, y1 - y0)
        if x1 <= x0 or y1 <= y0:
            raise InputError(
                f"scene '{scene.name}': the render region is {x1 - x0} x {y1 - y0} pixels; draw a"
                " larger one, or switch Render Region off"
            )
    if region[2] * region[3] > MAX_PIXELS:
        raise InputError(
            f"scene '{scene.name}': {region[2]} x {region[3]} pixels are more than"
            f" {MAX_PIXELS:,}; lower the resolution or render it in regions"
        )
    return Film(
        width,
        height,
        region,
        render.film_transparent,
        scene.aplanat.pixel_filter,
        filter_size(render),
    )


def filter_size(render):
    """Return the size of the pixel filter: as Cycles, not below a hundredth of a pixel.

    Blender's own setting goes down to 0, which leaves a filter no area to divide by.
    """
    return max(render.filter_size, _LEAST_FILTER_SIZE)


def _pixel(fraction, size):
    """Return the pixel at a border's edge: Blender multiplies in single precision, rounds down."""
    return int(np.float32(fraction) * np.float32(size))


def read_sampling(scene):
    """Return how a final render is sampled."""
    return _read_sampling(scene.aplanat, RENDER, "render")


def read_preview_sampling(scene):
    """Return how a viewport is sampled: as the final render, with its own numbers."""
    return replace(_read_sampling(scene.aplanat, PREVIEW, "preview"), progressive=True)


def _read_sampling(settings, numbers, prefix):
    wanted = getattr(settings, f"{prefix}_error") if settings.use_target_error else None
    return Sampling(
        **fields_of(settings, SAMPLING, numbers, ADVANCED, LEVELS, LIGHT, MEASURING),
        target_error=wanted,
        time_limit=getattr(settings, f"{prefix}_time_limit") or None,
        reuse_grid=settings.sharing_cells if settings.use_sharing else 0,
    )


def read_passes(view_layer):
    """Return the names of the passes that a view layer asks for.

    Parameters
    ----------
    view_layer : bpy.types.ViewLayer
        Blender's own switches are read, and ours of `view_layer.aplanat`.

    Returns
    -------
    tuple of str
        As in Blender; Combined is always the first.
    """
    ours = fields_of(view_layer.aplanat, PASSES)
    wanted = (
        getattr(view_layer, entry.blenders_switch) if entry.blenders_switch else ours.get(name)
        for name, entry in render_passes.PASSES.items()
    )
    names = ["Combined", *itertools.compress(render_passes.PASSES, wanted)]
    # Two ranks a pass.
    passes = (view_layer.pass_cryptomatte_depth + 1) // 2
    for kind, wanted in (
        ("CryptoObject", view_layer.use_pass_cryptomatte_object),
        ("CryptoMaterial", view_layer.use_pass_cryptomatte_material),
    ):
        names += [f"{kind}{i:02d}" for i in range(passes if wanted else 0)]
    return tuple(names)
