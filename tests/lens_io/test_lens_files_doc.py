"""docs/lens-files.md describes the format that is read."""

import re
from pathlib import Path

from addon.lens_io.toml import lens_tables, material, surface_tables
from addon.lens_io.toml.toml_reader import parse_lens

PAGE = Path(__file__).resolve().parents[2] / "docs" / "lens-files.md"
TEXT = PAGE.read_text(encoding="utf-8")


def test_the_example_loads_without_a_warning():
    example = re.search(r"```toml\n(format.*?)```", TEXT, re.DOTALL).group(1)
    assert parse_lens(example.encode(), "example").warnings == ()


def test_every_code_is_described_once():
    codes = [*(f"E{number:02}" for number in range(1, 26)), *(f"W0{n}" for n in range(1, 7))]
    assert re.findall(r"^\| ([EW]\d\d) \|", TEXT, re.MULTILINE) == codes


def test_every_key_is_described():
    keys = {
        *lens_tables.LENS_KEYS,
        *lens_tables.DIAPHRAGM_KEYS,
        *lens_tables.ZOOM_KEYS,
        *lens_tables.FOCUS_KEYS,
        *surface_tables.SURFACE_KEYS,
        *material.MATERIAL_KEYS,
    }
    assert [key for key in sorted(keys) if not re.search(rf"`.*\b{key}\b.*`", TEXT)] == []
