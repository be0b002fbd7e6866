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
    own = view_layer.aplanat
    switches = (
        ("Depth", view_layer.use_pass_z),
        ("Normal", view_layer.use_pass_normal),
        ("Position", view_layer.use_pass_position),
        ("Vector", view_layer.use_pass_vector),
        ("CoC", own.use_pass_coc),
        ("Focus Matte", own.use_pass_focus_matte),
    )
    names = ["Combined", *(name for name, wanted in switches if wanted)]
    # Two ranks a pass.
    passes = (view_layer.pass_cryptomatte_depth + 1) // 2
    for kind, wanted in (
        ("CryptoObject", view_layer.use_pass_cryptomatte_object),
        ("CryptoMaterial", view_layer.use_pass_cryptomatte_material),
    ):
        names += [f"{kind}{i:02d}" for i in range(passes if wanted else 0)]
    return tuple(names)
