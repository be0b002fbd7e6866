"""`aplanat bench --bokeh discs`: discs of lamps against the same lamps by lens samples.

Small shining balls stand before the focus and far behind it, at three places of the field, and are
seen through real lenses. The adaptive method draws a disc for each of their pixels; the reference
method draws them as everything else, by very many rays through the same lens. Light is not brought
to the same: an even exposure promises that discs and samples have the same.

Of each lamp a square is compared as `benchmarks.bokeh.lamp_pictures` does. The truth is the mean of
two renders with seeds of their own, whose difference tells how much noise it has.
"""

from dataclasses import replace

import numpy as np

from addon.cli.render.scene_setup import use_engine
from addon.optics.lens_facts import squeeze

from .frames import BokehScene
from .lamp_pictures import compare_lamp, save_sheets
from .lens import FIELDS
from .lens_chart import CROP, chart_scene, lens_chart

DEPTHS = (0.5, 10.0)
LENSES = (
    "petzval-51mm-f1.4", "double-gauss-50mm-f2", "sonnar-50mm-f1.5", "retrofocus-35mm-f2.5",
    "anamorphic-60mm-f2",
)  # fmt: skip
# Of the reference method, in two renders together.
SAMPLES = 16384
# Radius of a lamp, px: with larger ones more samples meet each pixel of a disc.
_LAMP = 2.0
WANTED_DB = 32.0


def discs(study):
    """Carry out the measure; parameters and result as of `benchmarks.bokeh.lens.lenses`."""
    samples = study.arguments.samples or SAMPLES
    found = []
    for name in LENSES:
        lamps, pictures = compare_discs_of(name, samples=samples, progress=study.console.progress)
        save_sheets(study, f"discs_{name}", pictures, ("discs", "samples"))
        found.append(
            {
                "lens": name,
                "samples": samples,
                "least_psnr_db": min(lamp["psnr_raw_db"] for lamp in lamps),
                "least_noise_db": min(lamp["noise_db"] for lamp in lamps),
                "lamps": lamps,
            }
        )
    return {"measure": "discs", "wanted_db": WANTED_DB, "lenses": found}


def compare_discs_of(
    name, depths=DEPTHS, fields=FIELDS, samples=SAMPLES, exposure="EVEN", progress=None
):
    """Draw and compare the lamps of a lens.

    Parameters
    ----------
    name : str
        Of a lens in the library.
    depths : sequence of float
        Over the focus distance.
    fields : sequence of tuple of 2 float
        Shares of half the picture's diagonal, and directions in degrees.
    samples : int
        Of the reference method, in two renders together.
    exposure : {'EVEN', 'LENS'}
    progress : callable, optional
        Called with what is being drawn.

    Returns
    -------
    found : list of dict
        One a lamp.
    pictures : list of tuple of 2 ndarray
        Discs and samples, (CROP, CROP), top row first.
    """
    progress = progress or (lambda what: None)
    chart = lens_chart(name)
    found, pictures = [], []
    for depth in depths:
        scene, lamps = chart_scene(chart, depth, fields, None, lamp=_LAMP, detail=2)
        use_engine(scene)
        data = scene.camera.data
        data.aplanat.exposure = exposure
        data.dof.aperture_ratio = squeeze(chart.prescription)
        bench = BokehScene(scene)
        try:
            # As of the middle of the lens: balls have no other side.
            snapshot = bench.splatted(4, 0, overscan=0.0)
            drawn = bench.draw_passes(snapshot).picture[::-1, :, 1]
            for field, _ in zip(fields, lamps, strict=True):
                progress(f"{name}: depth {depth:.3g} of the focus, field {field[0]:.1f}")
                x, y = chart.corner(field).tolist()
                ours = drawn[y : y + CROP, x : x + CROP][::-1]
                pair = [
                    bench.draw(_corner(bench, samples // 2, seed, (x, y))).picture[..., 1]
                    for seed in (0, 1)
                ]
                # Rows of the bench's pictures run as the renderer's.
                likeness, compared = compare_lamp(ours, [np.asarray(each)[::-1] for each in pair])
                found.append({"depth": depth, "field": field[0], **likeness})
                pictures.append(compared)
        finally:
            bench.close()
    return found, pictures


def _corner(bench, samples, seed, corner):
    """Return the snapshot of a square by the reference method."""
    snapshot = bench.sampled("REFERENCE", samples)
    film = replace(snapshot.film, region=(*corner, CROP, CROP))
    return replace(snapshot, film=film, sampling=replace(snapshot.sampling, seed=seed))
