"""Fixtures of the tests of what a user meets."""

import pytest


@pytest.fixture
def preset_folder(aplanat_bpy, tmp_path, monkeypatch):
    """A folder of the user's presets, in place of the real one."""

    def user_resource(*_, path="", **__):
        (tmp_path / path).mkdir(parents=True, exist_ok=True)
        return str(tmp_path / path)

    def preset_paths(subdir):
        folder = tmp_path / "presets" / subdir
        return [str(folder)] if folder.is_dir() else []

    monkeypatch.setattr(aplanat_bpy.utils, "user_resource", user_resource)
    monkeypatch.setattr(aplanat_bpy.utils, "preset_paths", preset_paths)
    return tmp_path / "presets"
