"""The table of passes, and how a view layer asks for them."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from addon.scene.settings import read_passes
from addon.settings.scene_settings import VIEW_LAYER
from addon.settings.setting import settings_of
from addon.snapshot import render_passes

OURS = settings_of(*VIEW_LAYER)
BLENDERS = ("z", "normal", "position", "vector", "cryptomatte_object", "cryptomatte_material")


def view_layer(depth=6, **switches):
    values = {f"use_pass_{name}": switches.get(name, False) for name in BLENDERS}
    own = {name: switches.get(name.removeprefix("use_pass_"), False) for name in OURS}
    return SimpleNamespace(pass_cryptomatte_depth=depth, aplanat=SimpleNamespace(**own), **values)


def test_combined_alone_is_the_default():
    assert read_passes(view_layer()) == ("Combined",)


@pytest.mark.parametrize(("depth", "passes"), [(2, 1), (5, 3), (6, 3), (16, 8)])
def test_a_cryptomatte_has_two_levels_a_pass(depth, passes):
    names = read_passes(view_layer(depth, cryptomatte_object=True, cryptomatte_material=True))
    assert render_passes.cryptomatte_kinds(names) == {
        "CryptoObject": passes,
        "CryptoMaterial": passes,
    }
    assert names[1] == "CryptoObject00"
    assert names[-1] == f"CryptoMaterial{passes - 1:02d}"


def test_every_name_that_can_be_asked_for_is_in_the_table():
    own = (name.removeprefix("use_pass_") for name in OURS)
    names = read_passes(view_layer(**dict.fromkeys((*own, *BLENDERS), True)))
    assert names[: len(render_passes.PASSES)] == tuple(render_passes.PASSES)
    table = [render_passes.render_pass(name) for name in names]
    assert [entry.name for entry in table] == list(names)
    assert {entry.kind for entry in table} == {"COLOR", "VALUE", "VECTOR"}
    assert all(len(entry.channels) in {1, 3, 4} for entry in table)


def test_an_unknown_pass_is_an_error():
    with pytest.raises(KeyError):
        render_passes.render_pass("Mist")


def test_a_pass_is_switched_on_in_one_place():
    ours = {setting.field for setting in OURS.values()}
    blenders = {name for name, entry in render_passes.PASSES.items() if entry.blenders_switch}
    assert not ours & blenders
    assert ours | blenders | {"Combined"} == set(render_passes.PASSES)


def test_the_page_of_passes_lists_the_table():
    page = (Path(__file__).resolve().parents[2] / "docs/passes.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| ")]
    listed = {name.strip() for row in rows for name in row.split(",")}
    assert set(render_passes.PASSES) <= listed
