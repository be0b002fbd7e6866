"""The built zip in a real Blender: valid, installs, registers, goes and comes back."""

import posixpath
import re
import zipfile


def test_zip_has_no_development_files(extension_zip):
    names = zipfile.ZipFile(extension_zip).namelist()
    assert "blender_manifest.toml" in names
    assert "__init__.py" in names
    for name in names:
        assert not name.startswith(("tests/", "scripts/", "benchmarks/", "requirements"))
        assert not name.startswith(("farm/", "findings/"))
        assert not name.endswith(".pyc")


def test_links_of_the_pages_in_the_zip_lead_somewhere(extension_zip):
    with zipfile.ZipFile(extension_zip) as file:
        names = set(file.namelist())
        pages = {name: file.read(name).decode() for name in names if name.endswith(".md")}
    assert "docs/reference/settings.md" in pages
    # README says of these that only a checkout has them.
    text, _, sources = pages["README.md"].partition("In a checkout of the sources")
    assert links("README.md", sources) >= {"docs/architecture.md", "docs/design-notes.md"}
    for page, body in (pages | {"README.md": text}).items():
        assert links(page, body) <= names, page


def links(page, text):
    """Return the files that a page links to, from the root of the zip."""
    found = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)
    return {posixpath.normpath(posixpath.join(posixpath.dirname(page), link)) for link in found}


def test_zip_brings_wheels_for_both_pythons(extension_zip):
    wheels = [n for n in zipfile.ZipFile(extension_zip).namelist() if n.endswith(".whl")]
    assert any("-cp313-" in name for name in wheels)
    assert any("-cp314-" in name for name in wheels)


def test_blender_validates_zip(bare_blender, extension_zip):
    done = bare_blender.run("--command", "extension", "validate", extension_zip)
    assert "error" not in (done.stdout + done.stderr).lower()


def test_enabled_extension_registers_engine(blender):
    done = blender.run_code(
        """
        import bpy
        bpy.context.scene.render.engine = "APLANAT"
        result = bpy.context.scene.render.engine
        """
    )
    assert done.result == "APLANAT"


def test_wheels_are_importable(blender):
    done = blender.run_code(
        """
        import OpenEXR
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        result = [OpenEXR.__version__, FigureCanvasAgg.__name__]
        """
    )
    assert all(done.result)


def test_zip_leaves_numpy_to_blender(extension_zip):
    wheels = [n for n in zipfile.ZipFile(extension_zip).namelist() if n.endswith(".whl")]
    assert not [name for name in wheels if "/numpy-" in name or "/scipy-" in name]


def test_disable_and_enable_again(blender):
    done = blender.run_code(
        """
        import addon_utils, bpy
        name = "bl_ext.user_default.aplanat"
        result = []
        for _ in range(3):
            addon_utils.disable(name)
            try:
                bpy.context.scene.render.engine = "APLANAT"
                result.append("still there")
            except TypeError:
                result.append("gone")
            addon_utils.enable(name)
            bpy.context.scene.render.engine = "APLANAT"
            result.append(bpy.context.scene.render.engine)
            bpy.context.scene.render.engine = "BLENDER_EEVEE"
        """
    )
    assert done.result == ["gone", "APLANAT"] * 3


def test_blender_command_prints_help(blender):
    done = blender.run("--command", "aplanat", "--help")
    assert "render" in done.stdout


def test_window_shows_engine(window, tmp_path):
    assert window.run('bpy.context.scene.render.engine = "APLANAT"; result = True')
    assert window.screenshot(tmp_path / "window.png").stat().st_size > 10_000
