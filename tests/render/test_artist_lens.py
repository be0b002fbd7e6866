"""An artist's lens in whole pictures: discs are what samples show, and stopping down sharpens."""

import numpy as np
import pytest

from tests.pictures import render_aplanat, render_picture

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def lamps(bpy):
    for place in ((-1.3, 0.7, -8.0), (0.135, -0.075, -0.85)):
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=2, radius=-0.005 * place[2], location=place
        )
        material = bpy.data.materials.new("lamp")
        tree = material.node_tree
        tree.nodes.clear()
        glow = tree.nodes.new("ShaderNodeEmission")
        glow.inputs["Strength"].default_value = 100.0
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
        bpy.context.object.data.materials.append(material)


@pytest.fixture
def lens(camera, aplanat_bpy):
    lamps(aplanat_bpy)
    camera.lens, camera.dof.use_dof = 85.0, True
    camera.dof.aperture_fstop, camera.dof.focus_distance = 1.4, 1.2
    return camera.aplanat


def test_discs_have_the_aberrations_of_samples(lens, empty_scene):
    lens.coma, lens.astigmatism, lens.swirl = 1.0, 1.0, 0.5
    lens.bokeh.use = False
    samples = render_aplanat(empty_scene, 256)[..., :3]
    scene = empty_scene.aplanat
    scene.method, scene.use_target_error, scene.render_samples = "ADAPTIVE", False, 8
    lens.bokeh.use = True
    discs = render_picture(empty_scene)[..., :3]
    lens.coma = lens.astigmatism = lens.swirl = 0.0
    thin = render_picture(empty_scene)[..., :3]
    error, without = (np.square(each - samples).mean() for each in (discs, thin))
    # Noise of the samples is most of it.
    assert error < 0.1 * without
    # Coma shows small lamps larger, by 4 % here: their discs are as much brighter.
    assert discs.sum() == pytest.approx(samples.sum(), rel=0.015)


def test_stopping_down_takes_the_aberrations_away(lens, empty_scene, camera):
    lens.bokeh.use = False
    errors = []
    for f_number in (1.4, 8.0):
        camera.dof.aperture_fstop = f_number
        lens.spherical = 0.0
        thin = render_aplanat(empty_scene, 32)[..., :3]
        lens.spherical = 1.0
        soft = render_aplanat(empty_scene, 32)[..., :3]
        errors.append(np.abs(soft - thin).sum() / thin.sum())
    assert errors[0] > 0.2 and errors[1] < 0.02
