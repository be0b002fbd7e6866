"""Lenses beside one another: the diagrams of a panel, and the sheet of the command line."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure

from addon.cli.command import main
from addon.lens_io.lens_shelf import LensShelf
from addon.plots import comparison
from addon.plots.comparison import DIAGRAM_SIZE, diagrams, own_state

FAST, SLOW = "achromat-100mm-f4", "singlet-planoconvex-100mm"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path / "cache"))


def state(name):
    return own_state(LensShelf([]).find(name).lens.prescription)


def of_color(picture, color):
    return (np.abs(picture[..., :3] - color).max(axis=-1) < 0.1).sum()


def test_diagrams_hold_a_line_of_each_lens_and_are_kept(monkeypatch):
    orange, blue = np.array([255, 181, 97]) / 255.0, np.array([111, 208, 232]) / 255.0
    alone = diagrams([state(FAST)])
    both = diagrams([state(FAST), state(SLOW)])
    for one, two in zip(alone, both, strict=True):
        assert one.shape == (DIAGRAM_SIZE, DIAGRAM_SIZE, 4)
        assert of_color(one, orange) > 100 and of_color(one, blue) == 0
        assert of_color(two, blue) > 100
    monkeypatch.setattr(comparison, "_draw_diagrams", None)
    for before, again in zip(both, diagrams([state(FAST), state(SLOW)]), strict=True):
        np.testing.assert_array_equal(before, again)


def test_diagrams_of_sharpness_are_the_contrast_of_the_lens():
    figure = Figure()
    axes = figure.add_axes((0, 0, 1, 1))
    comparison._sharpness(axes, [state(FAST), state(SLOW)], ("r", "b"))
    achromat, singlet = (line.get_ydata()[0] for line in axes.lines[::2])
    # Colours of a single piece of glass are in focus one after the other.
    assert 100.0 >= achromat > 1.5 * singlet > 0.0


def test_two_lenses_are_drawn_side_by_side(tmp_path, capfd, monkeypatch):
    # What a sheet of discs shows is tested with the sheet.
    blank = np.zeros((256, 256, 4), np.float32)
    monkeypatch.setattr(comparison, "bokeh_sheet", lambda *_: blank)
    path = tmp_path / "both.svg"
    words = ["lens", "plot", "--compare", FAST, "zoom-36-69mm-f3.5", "--zoom", "50 mm"]
    assert main([*words, "-o", str(path), "--json"]) == 0
    told = json.loads(capfd.readouterr().out)
    assert told["labels"] == [None, "50 mm"] and told["files"] == [str(path)]
    text = path.read_text(encoding="utf-8")
    for part in (*told["names"], "Points of light", "Sharpness", "Light that rims", "at 50 mm"):
        assert part in text, part


def test_one_lens_or_two_are_to_be_named(capfd):
    for words in ([], [FAST, "--compare", FAST, SLOW]):
        assert main(["lens", "plot", *words, "-o", "a.png"]) == 2
        assert "--compare A B" in capfd.readouterr().err
