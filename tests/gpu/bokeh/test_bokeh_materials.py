"""Materials that never shine as bokeh: their light is sampled whole."""

from dataclasses import replace

import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings

from ..conftest import render_snapshot, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

PASSES = ("Combined", "Defocus", "Bokeh")
LENS = ThinLens(0.5, 3.0, Iris())


def lamp(x, depth, size=0.2):
    return [(x - size, -size, -depth), (x + size, -size, -depth), (x, size, -depth)]


def snapshot_of_lamps(highlights, bokeh=True):
    """Return two lamps behind the focus, and whether each may shine as bokeh."""
    snapshot = triangles_snapshot(
        [lamp(-1.0, 6.0), lamp(1.0, 6.0)], [(40, 20, 10), (10, 20, 40)], 96, 64, LENS, 8, PASSES
    )
    materials = {
        uid: replace(material, highlights=may)
        for (uid, material), may in zip(snapshot.content.materials.items(), highlights, strict=True)
    }
    return replace(
        snapshot,
        content=replace(snapshot.content, materials=materials),
        camera=replace(snapshot.camera, bokeh=BokehSettings() if bokeh else None),
        sampling=replace(snapshot.sampling, reference_bokeh=True),
    )


def test_only_the_other_lamp_is_splatted_and_no_light_is_lost():
    both = render_snapshot(snapshot_of_lamps((True, True)))
    left = render_snapshot(snapshot_of_lamps((True, False)))
    plain = render_snapshot(snapshot_of_lamps((True, True), bokeh=False))
    half = left["Bokeh"].shape[1] // 2
    assert left["Bokeh"][:, :half].sum() > 0.0
    assert not left["Bokeh"][:, half:].any()
    # The right lamp is sampled to the last bit as without bokeh, the left one as with it.
    assert np.array_equal(left["Defocus"][:, half:], plain["Combined"][:, half:])
    assert np.array_equal(left["Defocus"][:, :half], both["Defocus"][:, :half])


def test_where_no_material_may_shine_the_picture_is_as_without_bokeh():
    found = render_snapshot(snapshot_of_lamps((False, False)))
    plain = render_snapshot(snapshot_of_lamps((True, True), bokeh=False))
    assert not found["Bokeh"].any()
    assert np.array_equal(found["Combined"], plain["Combined"])
