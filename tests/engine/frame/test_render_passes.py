"""The table of passes."""

import pytest

from addon.engine.frame import render_passes
from addon.scene.settings import read_passes


class Record:
    """Attributes by keyword."""

    def __init__(self, **values):
        self.__dict__.update(values)


def view_layer(depth=6, **switches):
    names = ("z", "normal", "position", "vector", "cryptomatte_object", "cryptomatte_material")
    values = {f"use_pass_{name}": switches.get(name, False) for name in names}
    own = Record(
        use_pass_coc=switches.get("coc", False),
        use_pass_focus_matte=switches.get("focus_matte", False),
        use_pass_defocus=switches.get("defocus", False),
        use_pass_bokeh=switches.get("bokeh", False),
        use_pass_detail=switches.get("detail", False),
        use_pass_fringe=switches.get("fringe", False),
        use_pass_sample_count=switches.get("sample_count", False),
    )
    return Record(pass_cryptomatte_depth=depth, aplanat=own, **values)


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
    names = read_passes(
        view_layer(
            z=True,
            normal=True,
            position=True,
            vector=True,
            defocus=True,
            bokeh=True,
            coc=True,
            focus_matte=True,
            fringe=True,
            sample_count=True,
            cryptomatte_object=True,
            cryptomatte_material=True,
        )
    )
    table = [render_passes.render_pass(name) for name in names]
    assert [entry.name for entry in table] == list(names)
    assert {entry.kind for entry in table} == {"COLOR", "VALUE", "VECTOR"}
    assert all(len(entry.channels) in {1, 3, 4} for entry in table)


def test_an_unknown_pass_is_an_error():
    with pytest.raises(KeyError):
        render_passes.render_pass("Mist")


def test_blender_is_told_name_channels_and_type():
    told = []
    engine = Record(register_pass=lambda *arguments: told.append(arguments[2:]))
    render_passes.register(engine, None, None, ("Combined", "Depth", "Vector", "CryptoObject01"))
    assert told == [
        ("Combined", 4, "RGBA", "COLOR"),
        ("Depth", 1, "Z", "VALUE"),
        ("Vector", 4, "XYZW", "VECTOR"),
        ("CryptoObject01", 4, "rgba", "COLOR"),
    ]
