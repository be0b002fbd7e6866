"""Where cached files go: the user's choice, or the system's place for them."""

import sys

from addon.files.cache_folder import cache_folder


def test_folder_is_the_users_choice_or_the_systems(monkeypatch, tmp_path):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path / "x"))
    assert cache_folder("levels") == tmp_path / "x" / "levels"
    monkeypatch.delenv("APLANAT_CACHE")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder("profiles") == tmp_path / "aplanat" / "profiles"
    monkeypatch.setattr(sys, "platform", "darwin")
    assert cache_folder("profiles").parts[-4:] == ("Library", "Caches", "aplanat", "profiles")
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert cache_folder("profiles") == tmp_path / "local" / "aplanat" / "profiles"
