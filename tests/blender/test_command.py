"""`blender --command aplanat` in the real Blender with the extension installed."""

import json
import subprocess

import pytest


@pytest.fixture(scope="module")
def cube(blender, tmp_path_factory):
    """Save Blender's own start-up scene, small."""
    path = tmp_path_factory.mktemp("command") / "cube.blend"
    blender.run_code(
        f"""
        import bpy
        bpy.context.scene.render.resolution_x = 64
        bpy.context.scene.render.resolution_y = 36
        bpy.ops.wm.save_as_mainfile(filepath={str(path)!r})
        """
    )
    return path


def run(blender, *words, folder=None):
    return subprocess.run(
        [blender.path, "--command", "aplanat", *map(str, words)],
        env=blender.env,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )


def test_renders_both_formats_and_answers_with_one_object(blender, cube, tmp_path):
    exr, png = tmp_path / "a.exr", tmp_path / "a.png"
    done = run(
        *(blender, "render", cube, "-o", exr, "-o", png, "--samples", "4", "--fstop", "0.5"),
        "--json",
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["lens_samples"] == 4 and answer["settings"]["fstop"] == 0.5
    assert exr.stat().st_size > 1000 and png.stat().st_size > 100
    assert all(line.startswith("aplanat: ") for line in done.stderr.splitlines()), done.stderr


def test_refuses_with_exit_code_2_and_one_line(blender, tmp_path):
    done = run(blender, "render", tmp_path / "none.blend", "-o", tmp_path / "a.png")
    assert (done.returncode, done.stdout) == (2, ""), done
    assert done.stderr.count("\n") == 1 and "does not exist" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_lens_is_told_and_drawn_with_the_bundled_libraries(blender, tmp_path):
    done = run(blender, "lens", "info", "double-gauss-50mm-f2", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["efl_mm"] == pytest.approx(50.3582, abs=1e-3)
    for name in ("sheet.png", "sheet.pdf"):
        words = ("lens", "plot", "double-gauss-50mm-f2", "-o", name, "--json")
        done = run(blender, *words, folder=tmp_path)
        assert done.returncode == 0, done.stderr
        # A relative name starts where the caller is.
        assert (tmp_path / name).stat().st_size > 10_000
        assert json.loads(done.stdout)["files"] == [name]
        assert all(line.startswith("aplanat: ") for line in done.stderr.splitlines()), done.stderr


def test_tables_are_baked_in_colour(blender, tmp_path):
    done = run(
        *(blender, "lens", "bake", "singlet-planoconvex-100mm", "-o", tmp_path / "lut.exr"),
        "--json",
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["channels"] == 3
    assert (tmp_path / "lut.exr").stat().st_size > 100_000
    assert all(line.startswith("aplanat: ") for line in done.stderr.splitlines()), done.stderr
