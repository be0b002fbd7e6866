"""The backs of glass, where light leaves it; see passes/surface/surface_refraction.glsl."""

from dataclasses import replace


def exits_of(target):
    """Return the target of the backs of glass, through the same lens as a picture's target.

    Parameters
    ----------
    target : SurfaceTarget

    Returns
    -------
    SurfaceTarget
    """
    kept = {"CHROMATIC", "REAL_LENS"}
    return replace(
        target,
        fragment="passes/surface/glass_exit_frag.glsl",
        outputs=(("VEC4", "out_exit"),),
        attributes=("normal",),
        defines=tuple(name for name in target.defines if name in kept),
        names_material=False,
        shades=False,
        splits=False,
        unsplit=frozenset(),
        refracts=False,
        deferred=False,
    )
