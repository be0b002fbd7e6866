"""Culling and masks of highlights against rays cast one by one, and against one another."""

from dataclasses import replace

import numpy as np
import pytest

from addon.device import readback
from addon.device.textures import texture_2d
from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.engine.visibility import stage
from addon.engine.visibility.stage import BokehVisibility, SceneOccluders
from addon.passes.bokeh.highlights import COLUMNS
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph
from benchmarks.reference.visibility import lens_places, seen

from ..conftest import make_renderer, render_snapshot, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

LENS = ThinLens(0.2, 3.0, Iris(ratio=1.25))
WIDTH, HEIGHT = 96, 64
BRIGHT = (20.0, 18.0, 16.0)
DARK = (0.1, 0.1, 0.1)
DROP, UNMASKED, MASKED, IN_SPLAT = range(4)


def square(x, y, depth, size):
    """Return two triangles that face the camera."""
    a, b, c, d = ((x + i * size, y + j * size, -depth) for j in (-1, 1) for i in (-1, 1))
    return [(a, b, c), (c, b, d)]


def slanted(count, seed=5):
    """Return random triangles between 1 and 2.5 m, and between 3.5 and 6 m."""
    rng = np.random.default_rng(seed)
    depth = np.concatenate([rng.uniform(1.2, 2.5, count), rng.uniform(3.5, 6.0, count)])
    corners = rng.uniform(-0.25, 0.25, (2 * count, 3, 3))
    corners[..., :2] += rng.uniform(-0.35, 0.35, (2 * count, 1, 2)) * depth[:, None, None]
    corners[..., 2] -= depth[:, None]
    return list(corners)


def snapshot(triangles, parallel=False, **settings):
    """Return a snapshot whose last two triangles shine, far behind everything."""
    lamp = square(0.0, 0.0, 9.0, 0.2)
    colors = [DARK] * len(triangles) + [BRIGHT] * len(lamp)
    plain = triangles_snapshot(
        [*triangles, *lamp], colors, WIDTH, HEIGHT, LENS, samples=16, parallel=parallel
    )
    return replace(
        plain,
        camera=replace(plain.camera, bokeh=BokehSettings(**settings)),
        sampling=replace(plain.sampling, reference_bokeh=True),
    )


class Scene:
    """A snapshot, and the tests and masks of sources that are put into it by hand."""

    def __init__(self, shot):
        self.shot = shot
        self.renderer = make_renderer(shot)
        self.plan = self.renderer.plan
        self.buffers = SceneBuffers()
        self.buffers.update(shot.content)
        self.occluders = SceneOccluders(shot.content, self.buffers)

    def find(self, sources, method, culls=True):
        """Return kinds, masks (None without), counts."""
        rows = -(-len(sources) // COLUMNS)
        table = np.zeros((rows * COLUMNS, 4), np.float32)
        table[: len(sources), :3] = sources
        table[: len(sources), 3] = 1.0
        texture = texture_2d(table.reshape(rows, COLUMNS, 4))
        visibility = BokehVisibility(self.plan, self.occluders, self.buffers)
        held = []
        drawing = self.renderer._drawing
        found = visibility.find(texture, len(sources), drawing, held, method, culls)
        framebuffer = held[-1].framebuffer("masks")
        atlas = readback.read_color(framebuffer, held[-1].width, held[-1].height, 1)[..., 0]
        tiles = np.asarray(found.tiles.read()).reshape(-1, 4)[: len(sources)]
        for targets in held:
            targets.release()
        masks = [
            atlas[int(y) : int(y + side), int(x) : int(x + side)] if kind == MASKED else None
            for x, y, side, kind in tiles
        ]
        return tiles[:, 3].astype(int), masks, found.counts

    def exact(self, source, side, clear=1e-4):
        """Return the mask of rays, with surfaces that are `clear` of the source."""
        corners = np.concatenate(
            [self.shot.content.meshes[g.mesh].positions[None] for g in self.shot.content.groups]
        ) * np.array([1.0, 1.0, -1.0])
        focus = LENS.focus_distance if self.plan.orthographic else None
        lens = lens_places(side) * self.plan.lens_extent
        return seen(source, corners, lens, 0.1, source[2] - clear, focus)


def sources_at(depths, seed=1, count=24, parallel=False):
    """Return places in the picture at some depths."""
    rng = np.random.default_rng(seed)
    depth = rng.choice(depths, count)
    places = rng.uniform(-0.4, 0.4, (count, 2)) * np.array([1.0, 0.6])
    scale = 4.0 if parallel else depth[:, None]
    return np.column_stack([places * scale, depth])


def at_an_edge(mask):
    """Return the texels whose neighbours differ."""
    padded = np.pad(mask, 1, "edge")
    shifted = [
        padded[i : i + mask.shape[0], j : j + mask.shape[1]] for i in range(3) for j in range(3)
    ]
    return np.ptp(np.array(shifted, float), axis=0) > 0.0


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("depths", [(7.0, 8.0), (1.9, 2.6)])
def test_rasterised_masks_are_those_of_rays(parallel, depths):
    scene = Scene(snapshot(slanted(9), parallel))
    sources = sources_at(depths, parallel=parallel)
    _, masks, counts = scene.find(sources, "RASTER", culls=False)
    assert counts.masked == len(sources)
    seen_in_part = 0
    for source, mask in zip(sources, masks, strict=True):
        exact = scene.exact(source, len(mask))
        # Beside the edges, where a rasteriser may decide otherwise in the last bit.
        sure = ~at_an_edge(exact)
        assert ((mask > 0.5) == exact)[sure].all()
        assert abs(mask.mean() - exact.mean()) < 0.02
        seen_in_part += 0.0 < exact.mean() < 1.0
    assert seen_in_part >= 2


@pytest.mark.parametrize("parallel", [False, True])
def test_warped_masks_are_those_of_rays(parallel):
    scene = Scene(snapshot(slanted(9), parallel))
    sources = sources_at((7.0, 8.0), parallel=parallel)
    _, masks, _ = scene.find(sources, "WARP")
    errors = [
        abs(mask - scene.exact(source, len(mask))).mean()
        for source, mask in zip(sources, masks, strict=True)
        if mask is not None
    ]
    # A texel of the layers is a third of a pixel, and one of these small masks most of a pixel:
    # single texels at an edge fall to the other side, a row of them where the edge is straight.
    assert len(errors) >= 5
    assert np.mean(errors) < 0.02
    assert max(errors) < 0.2


def test_what_lies_to_the_right_hides_the_right_of_the_lens():
    # A wall that ends on the axis, before and behind the plane of focus.
    for depth in (1.5, 4.0):
        scene = Scene(snapshot(square(1.0, 0.0, depth, 1.0)))
        for method in ("RASTER", "WARP"):
            _, (mask,), _ = scene.find(np.array([[-0.02, 0.0, 7.0]]), method, culls=False)
            half = mask.shape[1] // 2
            assert mask[:, : half - 1].mean() == 1.0
            assert mask[:, half + mask.shape[1] // 4 :].mean() == 0.0


@pytest.mark.parametrize("method", ["RASTER", "WARP"])
def test_culling_leaves_out_only_what_needs_no_mask(method):
    scene = Scene(snapshot(slanted(4)))
    sources = sources_at((2.0, 5.0, 8.0), count=200)
    kinds, masks, counts = scene.find(sources, method)
    _, full, _ = scene.find(sources, method, culls=False)
    assert (kinds == UNMASKED).sum() >= 40
    for source, kind, mask, whole in zip(sources, kinds, masks, full, strict=True):
        disc = np.hypot(*np.moveaxis(lens_places(len(whole)), -1, 0)) < 1.0
        if kind == UNMASKED:
            assert whole[disc].all(), source
        elif kind == DROP:
            assert not whole[disc].any(), source
        else:
            np.testing.assert_array_equal(mask[disc], whole[disc])
    named = counts.outside + counts.hidden + counts.visible + counts.free + counts.masked
    assert named == len(sources)


def test_what_is_behind_a_wall_is_dropped():
    scene = Scene(snapshot(square(0.0, 0.0, 4.0, 4.0)))
    kinds, _, counts = scene.find(sources_at((7.0, 8.0), count=50), "AUTO")
    assert (kinds == DROP).all()
    assert counts.hidden == 50


def test_what_cannot_reach_the_frame_is_dropped():
    scene = Scene(snapshot(slanted(3)))
    aside = np.array([[-40.0, 0.0, 8.0], [0.0, 30.0, 8.0], [0.0, 0.0, 8.0]])
    kinds, _, counts = scene.find(aside, "RASTER")
    assert counts.outside == 2
    assert kinds[2] != DROP


def test_masks_repeat_to_the_bit():
    scene = Scene(snapshot(slanted(9)))
    sources = sources_at((7.0, 8.0), count=300)
    for method in ("RASTER", "WARP"):
        _, first, _ = scene.find(sources, method)
        _, second, _ = scene.find(sources, method)
        for a, b in zip(first, second, strict=True):
            assert (a is None and b is None) or np.array_equal(a, b)


def see_through(share):
    """Return the graph of a surface that lets a share of the light through."""
    white = (("Color", Constant((1.0, 1.0, 1.0))),)
    mix = (("Fac", Constant((share,))), ("Shader", Link(0, "Emission")))
    nodes = (
        ShaderNode("emission", (("Color", Constant(DARK)), ("Strength", Constant((1.0,))))),
        ShaderNode("transparent", white),
        ShaderNode("mix_shader", (*mix, ("Shader_001", Link(1, "BSDF")))),
    )
    return SurfaceGraph(nodes, Link(2, "Shader"))


@pytest.mark.parametrize("method", ["RASTER", "WARP"])
def test_surfaces_that_let_light_through_multiply(method):
    shot = snapshot([*square(0.0, 0.0, 4.0, 3.0), *square(0.0, 0.0, 2.0, 3.0)])
    shares = [0.5, 0.5, 0.25, 0.25]
    materials = dict(shot.content.materials)
    for share, group in zip(shares, shot.content.groups, strict=False):
        uid = group.materials[0]
        materials[uid] = replace(materials[uid], graph=see_through(share))
    shot = replace(shot, content=replace(shot.content, materials=materials))
    _, (mask,), counts = Scene(shot).find(np.array([[0.1, 0.1, 7.0]]), method)
    assert counts.surface_pairs >= 2
    inner = ~at_an_edge(np.abs(mask - 0.125) < 0.02)
    # 8 bits of opacity, half floats of the mask.
    np.testing.assert_allclose(mask[inner], 0.125, atol=0.005)
    assert inner.mean() > 0.5


@pytest.mark.parametrize("lamp_depth", [7.0, 1.6])
@pytest.mark.parametrize("method", ["RASTER", "WARP", "SPLAT"])
def test_a_half_hidden_highlight_looks_as_lens_samples_show_it(lamp_depth, method):
    occluder = square(0.5, 0.06, 0.75 * lamp_depth, 0.5)
    lamp = square(0.0, 0.0, lamp_depth, 0.01 * lamp_depth)
    plain = triangles_snapshot(
        [*occluder, *lamp],
        [DARK] * 2 + [(300.0,) * 3] * 2,
        WIDTH,
        HEIGHT,
        LENS,
        samples=2048,
    )
    whole = render_snapshot(plain)["Combined"][..., :3]
    shot = replace(
        plain,
        camera=replace(plain.camera, bokeh=BokehSettings(visibility=method)),
        sampling=replace(plain.sampling, reference_bokeh=True, lens_samples=64),
        passes=("Combined", "Bokeh"),
    )
    pictures = render_snapshot(shot)
    splatted = pictures["Combined"][..., :3]
    assert pictures["Bokeh"].max() > 0.5
    error = np.abs(splatted - whole).sum() / whole.sum()
    mirrored = np.abs(splatted[::-1, ::-1] - whole).sum() / whole.sum()
    # Edges of a pixel round a disc of about ten, and the samples' own noise.
    assert error < 0.12
    assert mirrored > 2.0 * error


def test_masks_are_the_same_where_pairs_are_listed_in_parts(monkeypatch):
    scene = Scene(snapshot(slanted(9)))
    # The last of them is the last of its table.
    sources = sources_at((7.0, 8.0), count=2048)
    monkeypatch.setattr(stage, "_LEAST_PAIRS", 1)
    monkeypatch.setattr(stage, "_WINDOW", 1024)
    _, in_parts, counts = scene.find(sources, "RASTER")
    assert counts.pairs > 2 * 1024
    monkeypatch.undo()
    _, at_once, _ = scene.find(sources, "RASTER")
    for a, b in zip(in_parts, at_once, strict=True):
        assert (a is None and b is None) or np.array_equal(a, b)


def test_rays_are_not_counted_as_longer_than_they_are_walked():
    # Sources close to a wide lens: the way over the raster is longer than the most steps of a ray.
    shot = snapshot([*square(0.0, 0.0, 0.11, 0.005), *slanted(9)])
    wide = ThinLens(1.0, 3.0, Iris())
    scene = Scene(replace(shot, camera=replace(shot.camera, lens=wide)))
    _, _, counts = scene.find(sources_at((0.25, 0.3)), "WARP")
    assert counts.work == (1 + 192) * counts.texels
