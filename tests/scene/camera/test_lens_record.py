"""Lens settings that a captured file keeps: as JSON and back into a camera, whole or in part."""

import json

import numpy as np

from addon.scene.camera.irises import IrisReader
from addon.scene.camera.lens_record import apply_lens, record_lens


def test_a_camera_gets_back_what_was_recorded(aplanat_bpy):
    bpy = aplanat_bpy
    camera = bpy.data.cameras.new("Camera")
    own = camera.aplanat
    own.lens, own.bokeh.use, own.bokeh.onion = "double-gauss-50mm-f2", False, 0.25
    own.bokeh.vignetting, own.chromatic.use = "ANALYTIC", True
    own.chromatic.use_equalizer, own.chromatic.axial_first = True, "T2"
    own.chromatic.curves.nodes["Equalizer"].mapping.curves[0].points[1].location = 1.0, 0.5
    iris = bpy.data.images.new("iris", 6, 4, float_buffer=True, is_data=True)
    pixels = np.linspace(0.0, 1.0, 96, dtype=np.float32)
    iris.pixels.foreach_set(pixels)
    own.bokeh.iris_image = iris
    told = json.loads(json.dumps(record_lens(camera)))
    again = bpy.data.cameras.new("Again")
    image = apply_lens(told, again)
    after = record_lens(again)
    after["iris"]["name"] = told["iris"]["name"]
    assert after == told
    assert again.aplanat.chromatic.curves != own.chromatic.curves
    wanted, found = (IrisReader().read(each, 0.3).picture for each in (iris, image))
    assert np.allclose(found, wanted / wanted.max(), atol=1e-4)


def test_what_is_not_known_stays_as_it_is(aplanat_bpy):
    camera = aplanat_bpy.data.cameras.new("Camera")
    before = record_lens(camera)
    odd = {"lens": 3, "bokeh": {"model": "NEW", "glitter": 1.0}, "chromatic": [], "iris": {}}
    assert apply_lens(odd, camera) is None
    assert record_lens(camera) == before
