"""Images in every projection, interpolation and extension."""

import tempfile
from pathlib import Path

import numpy as np

from .case import Case


def _picture(width, height, alpha=False, is_float=True, space="Non-Color"):
    def prepare(bpy, node):
        pixels = np.random.default_rng(width + height).random((height, width, 4))
        if not alpha:
            pixels[..., 3] = 1.0
        image = bpy.data.images.new("image", width, height, alpha=True, float_buffer=is_float)
        image.colorspace_settings.name = space
        image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).reshape(-1))
        image.update()
        image.pack()
        node.image = image

    return prepare


def _sky(kind, gain, vector="place", **settings):
    inputs = {"Vector": vector} if vector else {}
    shown = {"sky_type": kind, "sun_disc": False, **settings}
    return Case("TexSky", "Color", inputs, shown, shape="dome", gain=gain)


def _tiles(bpy, node):
    """Three UDIM tiles in files, of two sizes and with a gap."""
    folder = Path(tempfile.mkdtemp())
    rng = np.random.default_rng(4)
    for number, size in ((1001, 4), (1002, 2), (1012, 4)):
        tile = bpy.data.images.new("tile", size, size, alpha=True)
        pixels = rng.random((size, size, 4), np.float32)
        pixels[..., 3] = 1.0
        tile.pixels.foreach_set(pixels.reshape(-1))
        tile.filepath_raw, tile.file_format = str(folder / f"tile.{number}.png"), "PNG"
        tile.save()
        bpy.data.images.remove(tile)
    node.image = bpy.data.images.load(str(folder / "tile.1001.png"))
    node.image.source = "TILED"
    node.image.filepath = str(folder / "tile.<UDIM>.png")
    for number in (1002, 1012):
        if not any(tile.number == number for tile in node.image.tiles):
            node.image.tiles.new(number)


# A street lamp's file: three half planes, five angles from straight down to up.
IES = """IESNA:LM-63-1995
[TEST] lamp
TILT=NONE
1 1000 1 5 3 1 1 0 0 0
1 1 100
0 30 60 90 180
0 90 180
100 80 50 20 10
100 60 40 30 5
100 90 20 10 0
"""


def _lamp(bpy, node):
    node.mode = "INTERNAL"
    node.ies = bpy.data.texts.new("lamp.ies")
    node.ies.write(IES)


# Few texels, so that a pixel's footprint is small: Cycles reads coarser pictures where it is not.
_SMALL = _picture(4, 3)

CASES = [
    *(
        Case(
            "TexImage",
            "Color",
            {"Vector": "signed"},
            {"extension": e, "interpolation": i},
            _picture(2, 2),
        )
        for e in ("REPEAT", "EXTEND", "CLIP", "MIRROR")
        for i in ("Linear", "Closest", "Cubic", "Smart")
    ),
    *(
        Case("TexImage", "Color", {"Vector": "generated"}, {"projection": p}, _SMALL, "dome")
        for p in ("FLAT", "BOX", "SPHERE", "TUBE")
    ),
    *(
        Case(
            "TexImage",
            "Color",
            {"Vector": "object"},
            {"projection": "BOX", "projection_blend": b},
            _SMALL,
            "dome",
        )
        for b in (0.1, 0.6, 1.0)
    ),
    *(
        Case("TexImage", "Color", {"Vector": v}, {"interpolation": i}, _tiles, exempt=0.06)
        # Texels closest to places between tiles change in the middle of pixels.
        for v, i in (
            *(("signed", "Linear"), ("signed", "Cubic")),
            *(("uv", "Linear"), ("uv", "Closest"), ("uv", "Cubic")),
        )
    ),
    Case("TexImage", "Alpha", {"Vector": "uv"}, {}, _picture(4, 3, alpha=True)),
    Case("TexImage", "Color", {"Vector": "uv"}, {}, _picture(4, 3, is_float=False, space="sRGB")),
    Case(
        "TexImage",
        "Color",
        {"Vector": "uv"},
        {},
        _picture(4, 3, is_float=False, space="Linear Rec.2020"),
    ),
    *(
        Case("TexEnvironment", "Color", {"Vector": "signed"}, {"projection": p}, _SMALL)
        for p in ("EQUIRECTANGULAR", "MIRROR_BALL")
    ),
    Case("TexEnvironment", "Color", {}, {}, _SMALL, "dome"),
    Case("TexEnvironment", "Color", {"Vector": "nowhere"}, {"interpolation": "Cubic"}, _SMALL),
    *(
        # At the file's angles the cubics bend within a texel of the picture.
        Case("TexIES", "Fac", {"Vector": v}, {}, _lamp, "dome", exempt=0.12, gain=0.2)
        for v in ("signed", "object", "bent")
    ),
    _sky("MULTIPLE_SCATTERING", 0.1, "signed"),
    _sky("MULTIPLE_SCATTERING", 0.1, None),
    _sky("MULTIPLE_SCATTERING", 0.1, "bent", sun_elevation=0.03, altitude=3000.0, air_density=2.0),
    _sky("MULTIPLE_SCATTERING", 0.1, "bent", sun_rotation=1.3, sun_elevation=1.2),
    _sky("SINGLE_SCATTERING", 0.1, "signed"),
    _sky("SINGLE_SCATTERING", 0.1, "straight up"),
    _sky("SINGLE_SCATTERING", 0.1, "bent", sun_elevation=0.03, aerosol_density=3.0),
    _sky("SINGLE_SCATTERING", 0.1, "bent", sun_rotation=1.3, sun_elevation=1.2, ozone_density=4.0),
    _sky("PREETHAM", 0.3, "signed", turbidity=4.0, sun_direction=(0.3, 0.4, 0.6)),
    _sky("HOSEK_WILKIE", 1.5, "signed", turbidity=4.3, sun_direction=(0.3, 0.4, 0.6)),
    _sky("HOSEK_WILKIE", 3.0, "bent", ground_albedo=0.9, sun_direction=(0.3, -0.4, 0.2)),
]
