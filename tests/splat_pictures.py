"""Pictures of one highlight, splatted with a look of choice; for tests and for a human's eye."""

from types import SimpleNamespace

import numpy as np

from addon.lens_bokeh.look.appearance import Appearance
from addon.sampling.iris import Iris
from addon.snapshot.camera import BokehSettings

FOCUS = 2.0


def plan_of(
    appearance=None, *, size=64, focal_px=200.0, radius=0.0125, iris=None, lens=None, focus=FOCUS,
    filter_width=1.4, **settings,
):  # fmt: skip
    """Return what a look needs to know of a plan: a square picture, `focal_px` a tangent of 1."""
    scale = 2.0 * focal_px / size
    projection = np.array(
        [[scale, 0, 0, 0], [0, scale, 0, 0], [0, 0, -1.0, -0.02], [0, 0, -1.0, 0]], float
    )
    from addon.device.textures import TextureCache

    settings = BokehSettings(appearance=appearance or Appearance(), **settings)
    iris = iris or Iris()
    bokeh = SimpleNamespace(
        settings=settings,
        iris=iris,
        real_lens=lens,
        filter_width=filter_width,
        projection=projection.copy(),
        lens_views=((0.0, 0.0),),
        colors=None,
        draft=False,
        artist=None,
        cylinders=None,
    )
    return SimpleNamespace(
        bokeh=bokeh,
        chromatic=None,
        focus_distance=focus,
        coc_scale=radius * focal_px,
        orthographic=False,
        lens_extent=np.array([radius / iris.ratio, radius]),
        projection=projection,
        size=size,
        focal_px=focal_px,
        # Pictures of one plan share what their looks are made of.
        textures=TextureCache(),
    )


def depth_of(plan, coc):
    """Return the depth whose circle of confusion has a signed radius, px."""
    return 1.0 / (1.0 / plan.focus_distance - coc / plan.coc_scale)


def splatted(plan, depth, chief=(0.0, 0.0), light=(1.0, 1.0, 1.0), window=None, extent=0.0):
    """Return the picture, (size, size, 4), of a point whose chief ray has these tangents.

    `window`: middle of the picture in pixels from the axis; None: the point itself.
    """
    from addon.device import geometry, readback
    from addon.device.targets import Targets, TargetSpec
    from addon.device.textures import texture_2d
    from addon.device.uniforms import uniform_buffer
    from addon.engine.bokeh.look import make_look
    from addon.passes.bokeh import splat
    from addon.passes.surface import surface

    size = plan.size
    middle = np.asarray(chief) * plan.focal_px if window is None else np.asarray(window)
    projection = plan.projection.copy()
    # Clip coordinates are divided by the depth: the third column moves the picture.
    projection[:2, 2] = middle / (0.5 * size)
    view = uniform_buffer(
        surface.VIEW_PARAMS.pack(
            view=np.eye(4),
            view_inverse=np.eye(4),
            projection=projection,
            lens=(plan.focus_distance, 0.0, plan.coc_scale, 0.5),
            film=(size, size, 0.0, 0.0),
        )
    )
    lists = np.zeros((3, 1, 1024, 4), np.float32)
    lists[0, 0, 0] = (chief[0] * depth, chief[1] * depth, depth, extent)
    lists[1, 0, 0] = (*light, 0.0)
    # Nothing hides it.
    lists[2, 0, 0] = (0.0, 0.0, 0.0, 1.0)
    textures = [texture_2d(table) for table in lists]
    textures.append(texture_2d(np.ones((1, 1, 4), np.float32)))
    with Targets(size, size, [TargetSpec("bokeh", "RGBA32F")]) as targets:
        targets.clear("bokeh", (0.0, 0.0, 0.0, 0.0))
        with targets.framebuffer("bokeh").bind():
            look = make_look(plan, plan.textures)
            densities = splat.splat(geometry.square_batch(), 1, textures, look, view)
        picture = readback.read_color(targets.framebuffer("bokeh"), size, size)
        densities.release()
        return picture


def library_lens(lens_id, f_number=None):
    """Return `LensSettings` of a lens that comes with Aplanat."""
    from addon.lens_io.lens_shelf import LensShelf
    from addon.snapshot.camera import LensSettings

    prescription = LensShelf([]).find(lens_id).lens.prescription
    configuration = prescription.configuration(None)
    f_number = max(f_number or 0.0, configuration.f_number)
    return LensSettings(lens_id, configuration.label, f_number, prescription)
