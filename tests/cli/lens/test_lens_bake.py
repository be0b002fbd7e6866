"""`aplanat lens bake`: a file that holds the tables, whole."""

import json

import numpy as np
import pytest

from addon.cli.command import main
from addon.lens_bokeh.tables.pupil_parts import unpack
from addon.lens_io.library import Library
from addon.lens_io.profile_cache import content_hash
from addon.lens_io.profile_file import load_profile


@pytest.fixture(scope="module")
def baked(tmp_path_factory):
    path = tmp_path_factory.mktemp("baked") / "lut.exr"
    words = ["lens", "bake", "zoom-36-69mm-f3.5", "--zoom", "50 mm", "--achromatic"]
    assert main([*words, "-o", str(path)]) == 0
    assert [each.name for each in path.parent.iterdir()] == ["lut.exr"]
    return path


def test_file_holds_profile_table_and_pupil(baked):
    stored = load_profile(baked)
    assert stored.profile.label == "50 mm"
    assert stored.table.density.shape == (1024, 1024, 1)
    # Single precision over a thousand rings.
    assert np.abs(stored.table.energies - 1.0).max() < 1e-5
    assert unpack(stored.words, stored.pictures).f_number == 3.5


def test_file_names_the_lens_by_id_and_content(baked):
    words = load_profile(baked).words
    prescription = Library().open("zoom-36-69mm-f3.5").prescription
    assert words["lensId"] == "zoom-36-69mm-f3.5"
    assert words["lensHash"] == content_hash(prescription, "50 mm")
    assert words["software"].startswith("Aplanat ")


def test_answer_tells_what_was_written(tmp_path, capfd):
    path = tmp_path / "lut.exr"
    assert main(["lens", "bake", "singlet-planoconvex-100mm", "-o", str(path), "--json"]) == 0
    answer = json.loads(capfd.readouterr().out)
    assert answer["files"] == [str(path)] and answer["channels"] == 3
    assert answer["row_energy_error"] < 1e-4
