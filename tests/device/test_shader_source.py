"""Includes are resolved once each, and a missing file is named."""

import pytest

from addon.device import shader_source
from addon.errors import ShaderCompileError


@pytest.fixture
def shaders(tmp_path, monkeypatch):
    """An empty shader folder."""
    monkeypatch.setattr(shader_source, "SHADER_ROOT", tmp_path)
    shader_source.load.cache_clear()
    yield tmp_path
    shader_source.load.cache_clear()


def test_an_include_appears_once_at_its_first_mention(shaders):
    (shaders / "a.glsl").write_text('#include "b.glsl"\n#include "c.glsl"\nlast\n')
    (shaders / "b.glsl").write_text('#include "c.glsl"\nb\n')
    (shaders / "c.glsl").write_text("c\n")
    assert shader_source.load("a.glsl").split() == ["c", "b", "last"]


def test_lines_remember_where_they_came_from(shaders):
    (shaders / "a.glsl").write_text('first\n#include "b.glsl"\nlast\n')
    (shaders / "b.glsl").write_text("\nb\n")
    places = {line: (path, number) for line, path, number in shader_source.located_lines("a.glsl")}
    assert places["first"] == ("a.glsl", 1)
    assert places["b"] == ("b.glsl", 2)
    assert places["last"] == ("a.glsl", 3)


def test_a_missing_include_is_named(shaders):
    (shaders / "a.glsl").write_text('#include "gone.glsl"\n')
    with pytest.raises(ShaderCompileError, match=r"gone\.glsl"):
        shader_source.load("a.glsl")


def test_a_text_is_put_together_once(shaders):
    (shaders / "a.glsl").write_text("first\n")
    parts = ("a.glsl", shader_source.Text("int generated;"))
    assert shader_source.join(parts) is shader_source.join(list(parts))
    other = shader_source.join(("a.glsl", shader_source.Text("int other;")))
    assert other != shader_source.join(parts)
