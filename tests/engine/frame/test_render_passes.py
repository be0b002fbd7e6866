"""Blender is told of the passes."""

from types import SimpleNamespace

from addon.engine.frame import render_passes


def test_blender_is_told_name_channels_and_type():
    told = []
    engine = SimpleNamespace(register_pass=lambda *arguments: told.append(arguments[2:]))
    render_passes.register(engine, None, None, ("Combined", "Depth", "Vector", "CryptoObject01"))
    assert told == [
        ("Combined", 4, "RGBA", "COLOR"),
        ("Depth", 1, "Z", "VALUE"),
        ("Vector", 4, "XYZW", "VECTOR"),
        ("CryptoObject01", 4, "rgba", "COLOR"),
    ]
