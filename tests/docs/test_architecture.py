"""docs/architecture.md leads to files that exist, by names that are in them."""

import importlib.util
import re
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
PAGE = REPO / "docs" / "architecture.md"
TEXT = PAGE.read_text(encoding="utf-8")
LINK = re.compile(r"\[([^\]]*)\]\(([^)#]+)(?:#[^)]*)?\)")
ROWS = [
    [cell.strip() for cell in line.strip("| ").split("|")]
    for line in TEXT.splitlines()
    if line.startswith("|") and not line.startswith(("| ---", "| method"))
]
WALKS = [part for part in TEXT.split("\n\n") if part.startswith("**...")]


def load(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def links(text):
    return [(PAGE.parent / target).resolve() for _, target in LINK.findall(text)]


@pytest.mark.parametrize(
    "name",
    [
        "README.md",
        "CONTRIBUTING.md",
        *sorted(str(path.relative_to(REPO)) for path in (REPO / "docs").glob("*.md")),
    ],
)
def test_links_of_a_page_lead_to_files(name):
    page = REPO / name
    targets = [target for _, target in LINK.findall(page.read_text(encoding="utf-8"))]
    missing = [
        target for target in targets if "://" not in target and not (page.parent / target).exists()
    ]
    assert not missing


def test_paths_in_the_text_exist():
    roots = (REPO, REPO / "addon", REPO / "addon" / "scene", REPO / "benchmarks", REPO / "tests")
    named = re.findall(r"`([a-z_.]+(?:/[\w.]+)*/?)`", TEXT)
    paths = [name for name in named if "/" in name or name.endswith((".py", ".glsl"))]
    assert paths
    roots += (REPO / "gpu_shaders",)
    assert not [name for name in paths if not any((root / name).exists() for root in roots)]


@pytest.mark.parametrize("row", ROWS, ids=[row[0] for row in ROWS])
def test_a_method_has_module_shader_test_and_bench(row):
    if row[1].startswith("not built"):
        return
    below = ("addon", "gpu_shaders", "tests", "benchmarks")
    for cell, folder in zip(row[1:], below, strict=True):
        for path in links(cell):
            assert path.is_file()
            assert path.is_relative_to(REPO / folder), f"{path} is not in {folder}/"
    assert links(row[1]) and links(row[3]) and links(row[4])


def test_every_method_is_in_the_table():
    numbers = [re.match(r"\d+", row[0]) for row in ROWS]
    assert [int(number[0]) for number in numbers if number] == list(range(1, 14))


@pytest.mark.parametrize("walk", WALKS, ids=[walk.split("?")[0][6:] for walk in WALKS])
def test_what_a_walk_names_is_in_the_files_that_it_leads_to(walk):
    text = "\n".join(path.read_text(encoding="utf-8") for path in links(walk))
    question, _, answer = walk.partition("?**")
    names = [name for name in re.findall(r"`([\w.]+)`", answer) if "/" not in name]
    assert links(answer)
    for name in names:
        assert re.search(rf"\b{name.rpartition('.')[2]}\b", text), f"{name}: {question}"


def test_the_walks_are_two_steps_from_the_readme():
    assert len(WALKS) >= 5
    readme = (REPO / "README.md").read_text(encoding="utf-8")
    assert "docs/architecture.md" in [target for _, target in LINK.findall(readme)]


def test_the_picture_is_drawn_from_the_rooms():
    script = load(REPO / "scripts" / "architecture_picture.py")
    assert script.PICTURE.read_text(encoding="utf-8") == script.draw(), (
        "run scripts/architecture_picture.py, and look at the picture"
    )


def test_a_frame_enters_each_room_once():
    script = load(REPO / "scripts" / "architecture_picture.py")
    rooms = script.rooms()
    assert set(script.WALK) <= set(rooms)
    steps = [f"{number}." for number in range(1, len(script.WALK) + 1)]
    told = [line.split()[0] for line in TEXT.splitlines() if re.match(r"\d+\. ", line)]
    assert told == steps


def test_every_room_is_on_the_map_of_contributing():
    text = (REPO / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rooms = {path.name for path in (REPO / "addon").iterdir() if path.is_dir()} - {"__pycache__"}
    assert not [name for name in sorted(rooms) if f"\n      {name}/ " not in text]


def test_the_readme_counts_the_shipped_lenses():
    readme = (REPO / "README.md").read_text(encoding="utf-8")
    count = len(list((REPO / "lens_profiles").glob("*.toml")))
    assert f"{count} prescriptions" in readme
