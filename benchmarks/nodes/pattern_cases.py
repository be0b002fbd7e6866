"""Procedural textures."""

from .case import Case

_PLACE = {"Vector": "signed"}


def _noise(output="Fac", inputs=(), **settings):
    numbers = {**_PLACE, "W": "x", "Scale": 1.3, "Detail": 2.6, **dict(inputs)}
    return Case("TexNoise", output, numbers, settings)


def _voronoi(output="Distance", inputs=(), **settings):
    numbers = {**_PLACE, "W": "x", "Scale": 0.7, **dict(inputs)}
    if settings.get("voronoi_dimensions") == "1D":
        numbers |= {"W": "x", "Scale": 4.0}
    return Case("TexVoronoi", output, numbers, settings)


_DIMENSIONS = ("1D", "2D", "3D", "4D")

NOISE = [
    *(_noise("Fac", noise_dimensions=d) for d in _DIMENSIONS),
    *(_noise("Color", noise_dimensions=d) for d in _DIMENSIONS),
    *(_noise("Color", {"Distortion": 0.7}, noise_dimensions=d) for d in _DIMENSIONS),
    *(
        _noise("Fac", {"Offset": 0.4, "Gain": 1.3}, noise_dimensions=d, noise_type=kind)
        for d in ("1D", "3D", "4D")
        for kind in (
            *("MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "HETERO_TERRAIN"),
        )
    ),
    _noise("Fac", {"Roughness": 0.8, "Lacunarity": 2.7, "Detail": 5.0}),
    _noise("Fac", normalize=False),
    _noise("Fac", {"Detail": 0.0}),
    Case("TexNoise", "Color", {"Scale": 3.0}),
    *(
        Case("TexWhiteNoise", "Value", {"Vector": "steps", "W": "steps"}, {"noise_dimensions": d})
        for d in _DIMENSIONS
    ),
    *(
        Case("TexWhiteNoise", "Color", {"Vector": "steps", "W": "steps"}, {"noise_dimensions": d})
        for d in _DIMENSIONS
    ),
]
VORONOI = [
    *(
        _voronoi(output, voronoi_dimensions=d, feature=feature)
        for d in _DIMENSIONS
        for feature in ("F1", "F2")
        for output in ("Distance", "Color")
    ),
    *(
        _voronoi(output, voronoi_dimensions=d, feature="SMOOTH_F1")
        for d in ("1D", "2D", "3D")
        for output in ("Distance", "Color")
    ),
    *(_voronoi("Distance", voronoi_dimensions=d, feature="DISTANCE_TO_EDGE") for d in _DIMENSIONS),
    *(_voronoi("Radius", voronoi_dimensions=d, feature="N_SPHERE_RADIUS") for d in _DIMENSIONS),
    *(
        _voronoi("Distance", {"Exponent": 1.7}, distance=metric, normalize=True, feature=feature)
        for metric in ("MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
        for feature in ("F1", "F2")
    ),
    *(
        _voronoi(
            output, {"Detail": 2.4, "Roughness": 0.6, "Lacunarity": 2.2}, normalize=n, feature=f
        )
        for n in (False, True)
        for f, outputs in (
            ("F1", ("Distance", "Color", "Position")),
            ("DISTANCE_TO_EDGE", ("Distance",)),
        )
        for output in outputs
    ),
    _voronoi("W", voronoi_dimensions="1D"),
    _voronoi("W", voronoi_dimensions="4D"),
    _voronoi("Position", voronoi_dimensions="2D", feature="F2"),
    _voronoi("Distance", {"Randomness": 0.3}),
]
OTHERS = [
    *(
        Case("TexWave", "Fac", {**_PLACE, "Scale": 0.4}, {"bands_direction": d, "wave_profile": p})
        for d, p in (("X", "SIN"), ("Y", "SAW"), ("Z", "TRI"), ("DIAGONAL", "TRI"))
    ),
    *(
        Case(
            "TexWave",
            "Color",
            {**_PLACE, "Scale": 0.3, "Distortion": 2.0, "Detail": 1.5, "Phase Offset": 0.4},
            {"wave_type": "RINGS", "rings_direction": d},
        )
        for d in ("X", "Y", "Z", "SPHERICAL")
    ),
    *(
        Case(
            "TexMagic",
            "Color",
            {**_PLACE, "Scale": 0.4, "Distortion": 1.3},
            {"turbulence_depth": n},
        )
        for n in range(11)
    ),
    Case("TexMagic", "Fac", {**_PLACE, "Scale": 0.4}),
    Case(
        "TexChecker",
        "Color",
        {**_PLACE, "Scale": 1.7, "Color1": (0.9, 0.2, 0.1), "Color2": (0.1, 0.4, 0.8)},
    ),
    Case("TexChecker", "Fac", {**_PLACE, "Scale": 0.9}),
    Case(
        "TexBrick",
        "Color",
        {**_PLACE, "Scale": 1.3, "Mortar Size": 0.08, "Color2": (0.9, 0.2, 0.1)},
    ),
    Case("TexBrick", "Fac", {**_PLACE, "Scale": 1.1, "Mortar Smooth": 0.0, "Mortar Size": 0.1}),
    Case(
        "TexBrick",
        "Color",
        {**_PLACE, "Scale": 1.6, "Bias": -0.3, "Mortar Smooth": 0.5, "Mortar Size": 0.06},
        {"offset": 0.3, "offset_frequency": 3, "squash": 0.6, "squash_frequency": 2},
    ),
    *(
        Case("TexGradient", "Fac", _PLACE, {"gradient_type": t})
        for t in (
            *("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE"),
            "RADIAL",
        )
    ),
]
GABOR = [
    *(
        Case("TexGabor", output, {**_PLACE, "Scale": 0.6, "Anisotropy": a}, {"gabor_type": kind})
        for kind in ("2D", "3D")
        for output, a in (("Value", 1.0), ("Value", 0.3), ("Phase", 0.6), ("Intensity", 0.0))
    ),
]
TILING = [
    *(
        Case("RadialTiling", name, {**_PLACE, "Sides": sides}, {"normalize": n})
        for sides, n in ((5.0, False), (5.0, True), (4.5, False))
        for name in (*("Segment Coordinates", "Segment ID", "Segment Width", "Segment Rotation"),)
    ),
    *(
        Case("RadialTiling", name, {**_PLACE, "Roundness": 1.0}, {"normalize": n})
        for n in (False, True)
        for name in ("Segment Coordinates", "Segment Width")
    ),
]
CASES = NOISE + VORONOI + OTHERS + GABOR + TILING
