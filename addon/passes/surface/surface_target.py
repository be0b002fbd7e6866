"""The kinds of render targets of surfaces, each with its variant of the surface shaders."""

from dataclasses import dataclass, replace

from . import chromatic, real_lens


@dataclass(frozen=True)
class SurfaceTarget:
    """A kind of render target of surfaces: the colour picture, data passes, ids, highlights.

    Parameters
    ----------
    fragment : str
        Entry point below ``gpu_shaders/``; it may call ``surface_closure()``.
    outputs : tuple of (str, str)
        Type and name by colour slot.
    varyings : tuple of (str, str)
        Outputs of its vertex shader besides the usual ones.
    attributes : tuple of str
        Mesh attributes that it reads itself, such as ``"normal"``, where the mesh has them.
    defines : tuple of str
    structs : str
        Declarations of its own uniform blocks.
    uniforms, samplers : tuple of (str, str)
        The target's own, bound once a shader through `draw_sample`'s `bindings`.
    images : tuple of tuples
        The target's own, as in `device.shaders.ShaderInfo`, bound as samplers are.
    push_constants : tuple of (str, str)
        The target's own.
    values : tuple of (str, str)
        Defines with a value.
    names_material : bool
        Its fragment shader reads the push constant `material_id`.
    shades : bool
        It calls ``surface_closure()`` for every surface, not only for transparent ones.
    splits : bool
        It splits light at the highlight threshold; reads ``highlight_buf``.
    unsplit : frozenset of (int, int)
        Group and slot of surfaces whose light it does not split.
    refracts : bool
        Its glass shows the picture of what is behind it, and is drawn after that.
    straight : bool
        Its glass lets light pass as if it were thin.
    seen : bool
        It is drawn through the lens: reads ``view_buf``, `lens_sample` and `sample_index`.
    blurs : bool
        It tells the circle of confusion.
    deferred : bool
        Opaque lit surfaces are shaded once a pixel; see `deferred`.
    vertex : str
        Its vertex shader below ``gpu_shaders/``; it must call ``forward_attributes()``.
    """

    fragment: str
    outputs: tuple[tuple[str, str], ...]
    varyings: tuple[tuple[str, str], ...] = ()
    attributes: tuple[str, ...] = ()
    defines: tuple[str, ...] = ()
    structs: str = ""
    uniforms: tuple[tuple[str, str], ...] = ()
    samplers: tuple[tuple[str, str], ...] = ()
    images: tuple[tuple, ...] = ()
    push_constants: tuple[tuple[str, str], ...] = ()
    values: tuple[tuple[str, str], ...] = ()
    names_material: bool = False
    shades: bool = True
    splits: bool = False
    unsplit: frozenset[tuple[int, int]] = frozenset()
    refracts: bool = False
    straight: bool = False
    seen: bool = True
    blurs: bool = False
    deferred: bool = False
    vertex: str = "passes/surface/surface_vert.glsl"


COLOR = SurfaceTarget("passes/surface/surface_frag.glsl", (("VEC4", "out_color"),), refracts=True)
# The same, with a second target from which Focus Matte and Cryptomattes are accumulated.
COLOR_AND_MATTES = SurfaceTarget(
    "passes/surface/surface_frag.glsl",
    (("VEC4", "out_color"), ("VEC4", "out_mattes")),
    defines=("MATTES",),
    names_material=True,
    refracts=True,
)
# Most pixels of a picture whose surfaces are shaded once a pixel, each of which takes up to 100
# bytes: a little more than 3840 x 2160.
_MOST_DEFERRED = 1 << 23
# The define of a target that splits light at the highlight threshold.
SPLIT = "HIGHLIGHTS"


def without_highlights(target, unsplit=frozenset()):
    """Return a target of the colour picture from which the splatted light is left out.

    Parameters
    ----------
    target : SurfaceTarget
    unsplit : frozenset of (int, int)
        Group and slot of surfaces of which nothing is splatted.

    Returns
    -------
    SurfaceTarget
    """
    return replace(target, splits=True, unsplit=unsplit, defines=(*target.defines, SPLIT))


def of_picture(mattes, shadows, raster):
    """Return the target of the colour picture.

    Parameters
    ----------
    mattes, shadows : bool
        With mattes; with shadows.
    raster : tuple of 2 int or None
        Width and height of what is drawn, px: places of a large one would take more memory than the
        time is worth. None for a target whose surfaces are not deferred.

    Returns
    -------
    SurfaceTarget
    """
    target = lit(COLOR_AND_MATTES if mattes else COLOR, shadows)
    return replace(target, deferred=bool(raster) and raster[0] * raster[1] <= _MOST_DEFERRED)


def lit(target, shadows):
    """Return a target whose lit surfaces are shadowed, or not: with shadows shaders are larger.

    Parameters
    ----------
    target : SurfaceTarget
    shadows : bool

    Returns
    -------
    SurfaceTarget
    """
    return replace(target, defines=(*target.defines, "SHADOWS")) if shadows else target


def whole(target):
    """Return the target for a surface whose light is not splatted."""
    if not target.splits:
        return target
    defines = tuple(name for name in target.defines if name != SPLIT)
    return replace(target, splits=False, defines=defines)


def of_layers(target):
    """Return the target of a peeled layer, shaded as seen from another place on the lens.

    It reads ``front_tx``, depths that surfaces must lie behind, and ``eye``, a place on the lens in
    m, or the focus distance's share of it as `lens_sample` has with a parallel projection.
    """
    return replace(
        target,
        deferred=False,
        defines=(*target.defines, "OF_LAYER"),
        samplers=(*target.samplers, ("FLOAT_2D", "front_tx")),
        push_constants=(*target.push_constants, ("VEC2", "eye")),
    )


def in_wavelengths(target):
    """Return a target whose surfaces are drawn at one wavelength a lens sample."""
    return replace(
        target,
        defines=(*target.defines, *(name for name, _ in chromatic.DEFINES)),
        structs=target.structs + chromatic.CHROMATIC_PARAMS.source,
        uniforms=(*target.uniforms, *chromatic.UNIFORMS),
        samplers=(*target.samplers, *chromatic.SAMPLERS),
        push_constants=(*target.push_constants, *chromatic.PUSH_CONSTANTS),
    )


def through_lens(target):
    """Return a target whose surfaces are drawn through a real lens."""
    target = replace(
        _with_lens(target),
        defines=(*target.defines, *(name for name, _ in real_lens.DEFINES)),
        samplers=(*target.samplers, *real_lens.SAMPLERS),
        push_constants=(*target.push_constants, *real_lens.PUSH_CONSTANTS),
    )
    return _with_blur(target) if _tells_blur(target) else target


def blurred_by_lens(target):
    """Return a target whose surfaces are drawn from the lens' middle, with the blur of a real lens.

    It reads what `real_lens.LensSample.blur_resources` gives, where the target tells the circle of
    confusion; others stay as they are.
    """
    return _with_blur(_with_lens(target)) if _tells_blur(target) else target


def _tells_blur(target):
    return target.blurs or "MATTES" in target.defines


def _with_lens(target):
    return replace(
        target,
        structs=target.structs + real_lens.REAL_LENS_PARAMS.source,
        uniforms=(*target.uniforms, *real_lens.UNIFORMS),
    )


def _with_blur(target):
    return replace(
        target,
        defines=(*target.defines, *(name for name, _ in real_lens.BLUR_DEFINES)),
        samplers=(*target.samplers, *real_lens.BLUR_SAMPLERS),
    )
