"""Lamps through real lenses against Cycles with an OSL camera that traces the same lenses."""

import math

import numpy as np
import pytest

from benchmarks.bokeh.lens import FIELDS, compare_lens, has_osl
from benchmarks.bokeh.lens_chart import lens_chart
from benchmarks.referees.osl_lens import osl_lens, shader_source
from tests.pictures import render_cycles, save_side_by_side

pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.skipif(not has_osl(), reason="this Blender's Cycles comes without OSL"),
]

LENS = "double-gauss-50mm-f2"


def test_discs_are_those_of_the_traced_lens(aplanat_bpy, tmp_path):
    found, pictures = compare_lens(
        lens_chart(LENS), depths=(0.625, 10.0), fields=(FIELDS[0], FIELDS[2]), samples=512
    )
    for number, (lamp, (ours, theirs)) in enumerate(zip(found, pictures, strict=True)):
        scale = theirs.sum() / ours.sum() / theirs.max()
        pair = [np.repeat(p[..., None], 3, axis=-1) for p in (ours * scale, theirs / theirs.max())]
        save_side_by_side(tmp_path / f"{number}.png", *pair)
        # The bar; noise of Cycles alone is at 35 dB or better.
        assert lamp["psnr_db"] >= 30.0, (lamp, tmp_path)


def test_the_traced_lens_shows_an_even_world_evenly_but_for_vignetting(empty_scene, tmp_path):
    import _cycles
    import bpy

    chart = lens_chart(LENS)
    lens = osl_lens(chart.prescription, None, chart.focus, 8.0)
    source = shader_source(lens, chart.sensor_size, chart.focal_length)
    (tmp_path / "lens.osl").write_text(source)
    assert _cycles.osl_compile(str(tmp_path / "lens.osl"), str(tmp_path / "lens.oso"))
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    empty_scene.collection.objects.link(camera)
    empty_scene.camera = camera
    empty_scene.world = bpy.data.worlds.new("world")
    background = next(n for n in empty_scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 48, 32
    data.type, data.custom_bytecode = "CUSTOM", (tmp_path / "lens.oso").read_text()
    data.custom_bytecode_hash = "0" * 32
    picture = render_cycles(empty_scene, 512)[..., 1]
    # Of 16 pixels; noise of 512 rays, of which a tenth gets through, is 4 % in each.
    assert picture[14:18, 22:26].mean() == pytest.approx(1.0, abs=0.03)
    # Closed down, the rims cut nothing: what is left is the cosine's fourth power.
    tangent = 0.45 * math.hypot(*chart.sensor_size) / chart.focal_length
    corner = picture[1:3, 1:3].mean()
    assert corner == pytest.approx(1.0 / (1.0 + tangent**2) ** 2, abs=0.12)
