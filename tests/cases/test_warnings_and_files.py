"""Cases in which something was silently missing: now each is told, or is there."""

import shutil

import numpy as np
import OpenEXR
import pytest

from tests.cli.conftest import aplanat  # noqa: F401 (a fixture)


@pytest.fixture
def case_copy(case_file, tmp_path):
    """Copy a named case to where its files may be written."""
    return lambda name: shutil.copy(case_file(name), tmp_path / f"{name}.blend")


@pytest.mark.parametrize(
    ("command", "options"),
    [("render", ("--samples", "4")), ("capture", ("--engine", "APLANAT", "--layers", "2"))],
)
def test_a_missing_library_is_told_by_name_and_refused_if_strict(
    aplanat,  # noqa: F811
    case_file,
    tmp_path,
    command,
    options,
):
    words = (command, case_file("r4-missing-library"), "-o", tmp_path / "a.exr", "--json")
    done = aplanat(*words, *options)
    assert done.code == 0, done.err
    (line,) = done.answer["warnings"]
    assert line.startswith("library '//gone.blend' cannot be read")
    assert "collection 'Lib'" in line
    (tmp_path / "a.exr").unlink()
    done = aplanat(*words, "--strict")
    assert done.code == 2 and done.answer["warnings"] == [line]
    assert not list(tmp_path.iterdir())


def test_motion_blur_is_told(aplanat, case_file, tmp_path):  # noqa: F811
    words = ("render", case_file("r5-motion-blur"), "-o", tmp_path / "a.exr", "--frame", "2")
    done = aplanat(*words, "--samples", "4", "--json")
    assert done.code == 0, done.err
    (line,) = done.answer["warnings"]
    assert "motion blur" in line and "'Scene'" in line


def test_file_output_nodes_number_their_files_as_blenders_animation_render(
    aplanat,  # noqa: F811
    aplanat_bpy,
    case_copy,
    tmp_path,
):
    blend = case_copy("r6-file-output")
    names = [f"node_{frame:04}.exr" for frame in (1, 2, 3)]
    aplanat_bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = aplanat_bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.frame_start, scene.frame_end, scene.render.save_output = 1, 3, False
    aplanat_bpy.ops.render.render(animation=True)
    folder = tmp_path / "files"
    assert sorted(path.name for path in folder.iterdir()) == names
    shutil.rmtree(folder)

    pattern = tmp_path / "own_####.exr"
    done = aplanat(
        *("render", blend, "-o", pattern, "--frames", "1..3", "--samples", "4", "--json")
    )
    assert done.code == 0, done.err
    assert sorted(path.name for path in folder.iterdir()) == names
    assert {str(folder / name) for name in names} <= set(done.answer["files"])
    for number, name in enumerate(names, 1):
        with OpenEXR.File(str(folder / name), separate_channels=True) as file:
            (green,) = [
                c.pixels for p in file.parts for n, c in p.channels.items() if n.endswith(".G")
            ]
        with OpenEXR.File(str(tmp_path / f"own_{number:04}.exr"), separate_channels=True) as file:
            (own,) = [
                c.pixels
                for p in file.parts
                for n, c in p.channels.items()
                if n == "ViewLayer.Combined.G"
            ]
        # Half precision, of values up to 1.
        np.testing.assert_allclose(green, own, atol=1e-3)
        assert own.max() > 0.5
