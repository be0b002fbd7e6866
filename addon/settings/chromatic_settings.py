"""Settings of a camera's chromatic aberration: strengths, glass, field maps, equalizer."""

from ..sampling.chromatic import SPECTRAL_RANGE_NM, WIDEST_RANGE_NM
from ..sampling.field_maps import ATOMS
from .setting import Item, Section, Setting

_PLACE = "Camera Properties > Chromatic Aberration"
# Each atom of a field map: its number, and what it does.
_ATOMS = tuple(
    Item(number, name, ATOMS[name], description)
    for number, name, description in (
        (0, "IDENTITY", "Rises evenly, from 0 in the middle of the picture to 1 in its corners"),
        (1, "T2", "Rises towards the corners"),
        (2, "T3", "Rises steeply towards the corners"),
        (3, "EXP", "Rises from 1 to 2.7"),
        (4, "ONE_MINUS", "Falls evenly, from 1 in the middle to 0 in the corners"),
        (5, "RECIPROCAL", "Grows without bound towards 0, where it is clamped"),
        (6, "COS_T", "A ring of the other sign halfway out"),
        (7, "COS_THETA", "From 1 on the right to -1 on the left, at any distance from the middle"),
        (8, "T_COS_THETA", "Rises to the right, falls to the left"),
        (9, "CURVE", "A curve that you draw"),
    )
)

# A table: what belongs to a setting stands together.
# fmt: off
STRENGTH = Section("Strength and glass", _PLACE, (
    Setting("use", False, "Chromatic Aberration", "Have the lens bend each color differently, as"
            " glass does", told="chromatic", kept=True),
    Setting("mode", "SPECTRAL", "Mode", "Which wavelengths are drawn. Both take as long",
            told="chromatic.mode", kept=True, items=(
            Item(0, "RGB", "RGB", "Red, green and blue light of 650, 510 and 475 nm: hard fringes"),
            Item(1, "SPECTRAL", "Spectral", "All wavelengths, a different one for each lens"
                 " sample"),
    )),
    Setting("axial", 1.0, "Axial", "How differently far away the colors are in focus: 1 as the"
            " glass does it, 0 not at all, negative the other way round", limits=(-1000.0, 1000.0),
            soft=(-10.0, 10.0), step=10, told="chromatic.axial", kept=True),
    Setting("lateral", 1.0, "Lateral", "How differently large the pictures of the colors are: 1"
            " as in a simple lens (2 % in the corners, from violet to red), 0 not at all,"
            " negative the other way round", limits=(-1000.0, 1000.0), soft=(-10.0, 10.0), step=10,
            told="chromatic.lateral_per_um", kept=True),
    Setting("dispersion", "GLASS", "Dispersion", "What says how strongly each wavelength is bent",
            told="chromatic.focal_ratio", kept=True, items=(
            Item(0, "GLASS", "Glass", "A simple lens of one glass"),
            Item(1, "LENS", "Real Lens", "The camera's real lens: rays of all wavelengths are"
                 " traced through it, so that the picture has its own axial and lateral color."
                 " Its d line (587.6 nm) is in focus"),
    )),
    Setting("focus_light", "MIDDLE", "Focus", "Which light the focus distance is meant for",
            told="chromatic.reference_nm", kept=True, items=(
            Item(0, "LONGEST", "Longest Wavelength", "The reddest light that is drawn; all other"
                 " colors are in focus nearer to the camera"),
            Item(1, "MIDDLE", "Middle", "The mean of all the light: what is at the focus distance"
                 " looks as sharp as it can"),
    )),
    Setting("glass", "N-BK7", "Glass", "Glass of the catalog. Flint (F2, N-SF11) parts the"
            " colors two to three times as much as crown (N-BK7)",
            told="chromatic.focal_ratio", kept=True),
    Setting("wavelength_min", SPECTRAL_RANGE_NM[0], "Wavelengths", "Shortest wavelength that is"
            " drawn, in nm",
            limits=WIDEST_RANGE_NM, soft=SPECTRAL_RANGE_NM, step=100, precision=0,
            told="chromatic.wavelengths_nm", kept=True),
    Setting("wavelength_max", SPECTRAL_RANGE_NM[1], "To", "Longest wavelength that is drawn, in"
            " nm", limits=WIDEST_RANGE_NM,
            soft=SPECTRAL_RANGE_NM, step=100, precision=0,
            told="chromatic.wavelengths_nm", kept=True),
))

MAPS = Section("Field maps", f"{_PLACE} > Axial Field Map, Lateral Field Map", tuple(
    Setting(f"{which}_{step}", "IDENTITY", label, f"What {what} with t, which is 0 in the middle"
            " of the picture and 1 in its corners. Theta is the angle around the middle, 0 on the"
            " right", told=f"chromatic.{which}_map", kept=True, items=_ATOMS)
    for which in ("axial", "lateral")
    for step, label, what in (
        ("first", "First", "is done first"),
        ("then", "Then", "is done with the outcome of the first step"),
    )
))

EQUALIZER = Section("Spectral equalizer", f"{_PLACE} > Spectral Equalizer", (
    Setting("use_equalizer", False, "Spectral Equalizer", "Weigh the wavelengths by a curve. What"
            " is in focus keeps its color", told="chromatic.equalizer", kept=True),
))
# fmt: on

CHROMATIC = (STRENGTH, MAPS, EQUALIZER)
