"""`aplanat lens plot`: data sheets that are whole, the same each time, and say what they show."""

import json
import re

import numpy as np
import pytest
from PIL import Image

from addon.cli.command import main


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    """Return a function that draws a lens and returns the file."""
    folder = tmp_path_factory.mktemp("sheets")

    def draw(lens, ending, *words):
        before = set(folder.iterdir())
        path = folder / f"{lens}{len(before)}.{ending}"
        assert main(["lens", "plot", lens, "-o", str(path), "--achromatic", *words]) == 0
        assert set(folder.iterdir()) - before == {path}
        return path

    return draw


@pytest.fixture(scope="module")
def drawing(sheet):
    return sheet("zoom-36-69mm-f3.5", "svg", "--zoom", "50 mm")


def test_svg_has_every_part(drawing):
    text = drawing.read_text(encoding="utf-8")
    for part in (
        *("at 50 mm", "US 4,266,860", "Longitudinal aberration", "Field curves", "Distortion"),
        *("Vignetting", "Spots in best focus", "Bokeh table", "Points of light", "f/3.5"),
    ):
        assert part in text, part


def test_the_same_lens_gives_the_same_drawing(sheet, drawing):
    again = sheet("zoom-36-69mm-f3.5", "svg", "--zoom", "50 mm")
    assert again.read_bytes() == drawing.read_bytes()
    # Neither a date nor a path of this machine.
    assert not re.search(r"\b20[2-9]\d-\d\d-\d\d", drawing.read_text(encoding="utf-8"))


def test_png_has_the_size_asked_for_and_ink_on_all_its_parts(sheet, capfd):
    path = sheet("fisheye-16mm-f2.8", "png", "--size", "960x720", "--json")
    assert json.loads(capfd.readouterr().out)["files"] == [str(path)]
    picture = np.asarray(Image.open(path).convert("L"))
    assert picture.shape == (720, 960)
    for rows in np.split(picture, 3):
        for part in np.split(rows, 4, axis=1):
            assert part.min() < 120


def test_pdf_is_written_for_a_lens_with_cylinders(sheet):
    # Which has no table over the radius: its disks are traced.
    path = sheet("anamorphic-60mm-f2", "pdf")
    assert path.read_bytes()[:5] == b"%PDF-"
    assert path.read_bytes().rstrip().endswith(b"%%EOF")
