"""Highlights in mirroring surfaces, seen from several places on the lens."""

from dataclasses import replace

import numpy as np
import pytest

from addon.lens_bokeh.openings.blades import BladedIris
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings, Camera
from addon.snapshot.content import (
    InstanceGroup,
    InstanceTable,
    Light,
    MaterialSnapshot,
    MeshSnapshot,
    SceneContent,
    World,
    next_uid,
)
from addon.snapshot.film import Film, Sampling
from addon.snapshot.scene import SceneSnapshot
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph

from ...conftest import perspective, render_snapshot
from ..bokeh_scenes import energy
from ..test_bokeh_passes import splatted

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 72, 48


@pytest.mark.parametrize("side", [2, 3])
@pytest.mark.parametrize("radius", [18.0, -18.0])
def test_the_regions_of_the_lens_add_up_to_the_whole(side, radius):
    iris = BladedIris(5, 0.2, 0.3)
    whole = splatted(radius, (32.3, 31.6), iris)
    parts = [splatted(radius, (32.3, 31.6), iris, region=n, side=side) for n in range(side**2 + 1)]
    assert np.abs(parts[0] - whole).max() == 0.0
    assert np.sum(parts[1:], axis=0) == pytest.approx(whole, rel=1e-5, abs=1e-9)
    assert min(part[..., 0].sum() for part in parts[1:]) > 0.0


def test_a_region_is_where_the_lens_sees_it_from():
    # Behind the focus, the disc stands as the lens does.
    picture = splatted(20.0, (32.0, 32.0), region=2, side=2)[..., 0]
    x, y = np.meshgrid(np.arange(64) - 31.5, np.arange(64) - 31.5)
    center = np.array([(picture * x).sum(), (picture * y).sum()]) / picture.sum()
    assert center[0] > 5.0 and center[1] < -5.0


def ball(columns=48, rows=24):
    """Return positions, triangles and normals of a unit ball."""
    u = np.linspace(0.0, 2.0 * np.pi, columns + 1)
    v = np.linspace(0.0, np.pi, rows + 1)
    u, v = np.meshgrid(u, v)
    around = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1)
    corner = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return around.reshape(-1, 3), triangles.reshape(-1, 3)


def glossy_ball(views, samples, bokeh=True, roughness=0.3):
    """Return a glossy ball out of focus that mirrors two lamps."""
    positions, triangles = ball()
    mesh = MeshSnapshot(
        next_uid(),
        "ball",
        positions.astype(np.float32),
        triangles.astype(np.int32),
        ((0, 0, len(triangles)),),
        {"normal": positions.astype(np.float32)},
    )
    gloss = ShaderNode(
        "glossy",
        (("Color", Constant((0.8, 0.8, 0.8))), ("Roughness", Constant((roughness,)))),
    )
    material = MaterialSnapshot(next_uid(), "gloss", SurfaceGraph((gloss,), Link(0, "BSDF")))
    world = np.eye(4, dtype=np.float32)
    world[:3, 3] = 0.0, 0.0, -7.0
    settings = BokehSettings(lens_views=views, threshold=1.0) if bokeh else None
    return SceneSnapshot(
        content=SceneContent(
            meshes={mesh.uid: mesh},
            images={},
            materials={material.uid: material},
            instances=InstanceTable(world[None], np.ones(1, np.float32), ("ball",)),
            groups=(InstanceGroup(mesh.uid, (material.uid,), 0, 1),),
            world=World((0.02, 0.02, 0.02)),
            lights=(
                Light("POINT", (4.0, 3.0, -4.0), (0.0, 0.0, -1.0), (40.0, 30.0, 20.0), 0.05),
                Light("POINT", (-5.0, 0.5, -3.0), (0.0, 0.0, -1.0), (20.0, 30.0, 60.0), 0.05),
            ),
        ),
        camera=Camera(
            np.eye(4),
            perspective(WIDTH, HEIGHT, 0.25),
            ThinLens(0.6, 3.0, Iris()),
            False,
            bokeh=settings,
        ),
        film=Film(WIDTH, HEIGHT, (0, 0, WIDTH, HEIGHT), False, "BOX", filter_size_px=1.0),
        sampling=Sampling("REFERENCE", samples, 0, reference_bokeh=True),
        passes=("Combined", "Bokeh"),
    )


def test_more_views_come_nearer_to_the_reference():
    reference = render_snapshot(glossy_ball(1, 2048, bokeh=False))["Combined"]
    errors = {}
    for views in (1, 4, 9):
        pictures = render_snapshot(glossy_ball(views, 256))
        # A third of the light and more, of which one place sees all in the same shape.
        assert pictures["Bokeh"][..., :3].sum() > 0.3 * reference[..., :3].sum()
        # What 256 samples leave open.
        assert energy(pictures["Combined"]) == pytest.approx(energy(reference), rel=0.005)
        error = (pictures["Combined"] - reference)[..., :3].astype(np.float64)
        errors[views] = np.sqrt((error**2).mean())
    assert errors[4] < 0.6 * errors[1]
    assert errors[9] < 0.85 * errors[4]


def test_light_of_small_glints_does_not_depend_on_the_number_of_views():
    # Glints of 0.6 px: with a texel of the search for a pixel, 4 and 16 views found a tenth less
    # light than there is, and 9 a thirtieth more.
    expected = energy(render_snapshot(glossy_ball(1, 512, bokeh=False, roughness=0.15))["Combined"])
    for views in (4, 9, 16):
        picture = render_snapshot(glossy_ball(views, 32, roughness=0.15))["Combined"]
        assert energy(picture) == pytest.approx(expected, rel=0.01)


def glossy_wall(views, samples, bokeh=True, focus=6.0):
    """Return a wall across the view, rough and hardly out of focus: all of it is a highlight."""
    snapshot = glossy_ball(views, samples, bokeh, roughness=1.0)
    (uid,) = snapshot.content.meshes
    square = np.array([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], np.float32)
    mesh = MeshSnapshot(
        uid,
        "wall",
        square,
        np.array([(0, 1, 2), (0, 2, 3)], np.int32),
        ((0, 0, 2),),
        {"normal": np.tile(np.float32((0.0, 0.0, 1.0)), (4, 1))},
    )
    lamp = Light("POINT", (1.0, 1.0, -2.0), (0.0, 0.0, -1.0), (8000.0, 6000.0, 4000.0), 0.05)
    content = replace(snapshot.content, meshes={uid: mesh}, lights=(lamp,))
    camera = replace(snapshot.camera, lens=ThinLens(0.6, focus, Iris(4, 0.8)))
    return replace(snapshot, content=content, camera=camera)


@pytest.mark.parametrize("focus", [6.0, 5.2])
def test_regions_of_small_discs_keep_their_light(focus):
    # Discs of 1.7 and 3.6 px: regions are a pixel wide, and all sources of one view lie at the same
    # place among the pixels. With nine views a seventh too much light was seen.
    expected = energy(render_snapshot(glossy_wall(1, 128, False, focus))["Combined"])
    for views in (4, 9):
        pictures = render_snapshot(glossy_wall(views, 32, focus=focus))
        assert energy(pictures["Bokeh"]).min() > 0.5 * expected.min()
        # The lamp's reflection is seen from so few places; what they miss is half a per cent.
        assert energy(pictures["Combined"]) == pytest.approx(expected, rel=0.006)
