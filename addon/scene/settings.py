"""Render settings of a scene to `Film` and `Sampling`."""

from dataclasses import replace

from .snapshot import Film, Sampling


def read_film(scene):
    """Return the raster of a scene's final render."""
    render = scene.render
    width = max(1, render.resolution_x * render.resolution_percentage // 100)
    height = max(1, render.resolution_y * render.resolution_percentage // 100)
    region = (0, 0, width, height)
    if render.use_border:
        x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
        y0, y1 = int(render.border_min_y * height), int(render.border_max_y * height)
        region = (x0, y0, x1 - x0, y1 - y0)
    settings = scene.aplanat
    return Film(
        width,
        height,
        region,
        render.film_transparent,
        settings.pixel_filter,
        render.filter_size,
    )


def read_sampling(scene):
    """Return how a final render is sampled."""
    settings = scene.aplanat
    return Sampling("REFERENCE", settings.render_samples, settings.seed)


def read_preview_sampling(scene):
    """Return how a viewport is sampled: as the final render, with its own number of samples."""
    return replace(read_sampling(scene), lens_samples=scene.aplanat.preview_samples)
