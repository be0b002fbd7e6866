"""Folders are small and files short."""

from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
# A folder that one finds one's way in at a glance, and a file that one reads in one sitting.
MOST_FILES, MOST_LINES = 16, 400
# A thing a file, found by its name, of which there may be any number; as of lens_profiles.
COLLECTIONS = {"findings"}

# All that is ours but lens_profiles.
TOPS = (*("addon", "benchmarks", "gpu_shaders", "tests", "scripts", "docs", "farm", "findings"),)


@pytest.mark.parametrize("top", TOPS)
def test_folders_are_small_and_files_short(top):
    folders, files = {}, {}
    for path in (REPOSITORY / top).rglob("*"):
        if "__pycache__" in path.parts or not path.is_file():
            continue
        folder = str(path.parent.relative_to(REPOSITORY))
        folders[folder] = folders.get(folder, 0) + 1
        if path.suffix in {".py", ".glsl", ".sh", ".js"}:
            files[str(path.relative_to(REPOSITORY))] = len(path.read_text().splitlines())
    crowded = {k: v for k, v in folders.items() if v > MOST_FILES and k not in COLLECTIONS}
    assert crowded == {}
    assert {k: v for k, v in files.items() if v > MOST_LINES} == {}
