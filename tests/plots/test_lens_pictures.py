"""Pictures by which a lens is recognised."""

import numpy as np
import pytest

from addon.errors import RenderCancelledError
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_io.library import SHIPPED_FOLDER
from addon.lens_io.toml.toml_reader import read_lens
from addon.plots import lens_pictures
from addon.plots.lens_pictures import SHEET_TILE, THUMBNAIL_SIZE, bokeh_sheet, thumbnail


def lens(name):
    return read_lens(SHIPPED_FOLDER / f"{name}.toml").prescription


def test_a_thumbnail_shows_section_and_three_neutral_disks(tmp_path):
    pixels = thumbnail(lens("tessar-50mm-f2.8"), folder=tmp_path)
    assert pixels.shape == (THUMBNAIL_SIZE, THUMBNAIL_SIZE, 4)
    assert pixels.dtype == np.float32 and pixels.min() >= 0.0 and pixels.max() <= 1.0
    section, disks = np.split(pixels[..., :3], [170])
    assert section.std(axis=(0, 1)).min() > 0.05
    for third in np.split(disks[4:80, 3:252], 3, axis=1):
        # The middle of a disk is light, its corners are not, and there is no colour.
        assert third[30:46, 30:46].mean() > third[:4, :4].mean() + 0.2
        assert np.ptp(third, axis=-1).max() < 0.03


def test_a_thumbnail_is_drawn_once(tmp_path, monkeypatch):
    prescription = lens("heliar-100mm-f4")
    first = thumbnail(prescription, folder=tmp_path)
    monkeypatch.setattr(lens_pictures, "_draw_thumbnail", None)
    assert np.array_equal(thumbnail(prescription, folder=tmp_path), first)
    with pytest.raises(TypeError):
        thumbnail(lens("tessar-50mm-f2.8"), folder=tmp_path)


def test_a_damaged_picture_on_disk_is_drawn_again(tmp_path):
    prescription = lens("heliar-100mm-f4")
    first = thumbnail(prescription, folder=tmp_path)
    (kept,) = tmp_path.glob("thumb-*.npy")
    kept.write_bytes(kept.read_bytes()[:1000])
    assert np.array_equal(thumbnail(prescription, folder=tmp_path), first)


def test_drawing_can_be_stopped(tmp_path):
    with pytest.raises(RenderCancelledError):
        thumbnail(lens("heliar-100mm-f4"), cancelled=lambda: True, folder=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_used_costs_time_only(tmp_path):
    (tmp_path / "file").write_text("")
    assert thumbnail(lens("singlet-planoconvex-100mm"), folder=tmp_path / "file").any()


def test_a_lens_with_cylinders_has_oval_disks(tmp_path):
    pixels = thumbnail(lens("anamorphic-60mm-f2"), folder=tmp_path)
    near = pixels[176:250, 6:82, :3].mean(axis=-1) > 0.3
    wide, high = np.ptp(np.flatnonzero(near.any(axis=0))), np.ptp(np.flatnonzero(near.any(axis=1)))
    assert high > 1.3 * wide


def test_a_sheet_shows_vignetting_towards_the_corner(tmp_path, monkeypatch):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path))
    told = []
    sheet = bokeh_sheet(lens("double-gauss-50mm-f2"), None, 2.03, BladedIris(), told.append)
    assert sheet.shape == (4 * SHEET_TILE, 4 * SHEET_TILE, 4)
    assert told == sorted(told) and told[-1] > 0.9
    lit = (sheet[..., :3].mean(axis=-1) > 0.15).astype(float)
    far = lit[:, 3 * SHEET_TILE :]
    axis, _, middle, corner = (tile.sum() for tile in np.split(far, 4))
    assert axis > 1.3 * middle > middle > 1.1 * corner
    # A disk on the axis is round.
    tile = far[:SHEET_TILE]
    assert (
        abs(np.ptp(np.flatnonzero(tile.any(axis=0))) - np.ptp(np.flatnonzero(tile.any(axis=1))))
        <= 1
    )
    # It is kept by lens, f-number and iris.
    monkeypatch.setattr(lens_pictures, "_draw_sheet", None)
    again = bokeh_sheet(lens("double-gauss-50mm-f2"), None, 2.03, BladedIris())
    assert np.array_equal(again, sheet)
    with pytest.raises(TypeError):
        bokeh_sheet(lens("double-gauss-50mm-f2"), None, 2.03, BladedIris(5))
