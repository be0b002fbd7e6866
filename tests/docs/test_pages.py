"""Links and pictures of the pages for users lead to files that are shipped with them."""

import re
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)#\s]+)(#[^)]*)?\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
# Pages for people who work on the sources are not in the package; see blender_manifest.toml.
MANIFEST = (REPO / "blender_manifest.toml").read_text(encoding="utf-8")
PAGES = [
    path
    for path in sorted((REPO / "docs").rglob("*.md"))
    if f'"/{path.relative_to(REPO)}"' not in MANIFEST
]


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_links_lead_to_pages_and_headings_that_are_shipped(page):
    for target, place in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        found = (page.parent / target).resolve()
        assert found.is_file(), f"{page.name}: {target}"
        assert f'"/{found.relative_to(REPO)}"' not in MANIFEST, f"{page.name}: {target}"
        if place and found.suffix == ".md":
            headings = HEADING.findall(found.read_text(encoding="utf-8"))
            assert place[1:] in map(anchor, headings), f"{page.name}: {target}{place}"


def test_pictures_of_the_tutorial_are_those_that_its_script_draws():
    script = (REPO / "scripts" / "pictures" / "tutorial.py").read_text(encoding="utf-8")
    drawn = {f"{name}.jpg" for name in re.findall(r'^    "(\d-\w+)": ', script, re.MULTILINE)}
    folder = REPO / "docs" / "images" / "tutorial"
    assert {path.name for path in folder.iterdir()} == drawn and len(drawn) > 3
    shown = LINK.findall((REPO / "docs" / "guide" / "tutorial.md").read_text(encoding="utf-8"))
    assert {Path(target).name for target, _ in shown if "tutorial/" in target} == drawn
