"""The look of a frame's bokeh discs: textures and parameters for the splat (methods 12, 13).

They follow from the camera's settings, the focus and the f-number; the shader adds depth and field.
Textures are made again only when their inputs have changed.

All discs keep their energy: tables hold the light that a profile, rims, or an opening over the
tiles of a real lens' pupil take away, and the shader divides by it.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...device.textures import texture_2d, texture_array
from ...device.uniforms import uniform_buffer
from ...errors import AplanatError
from ...lens_bokeh.look import splat_pupil, splat_rims
from ...lens_bokeh.look.opening import LAYERS, LEAST_BLUR, layers_of_mask
from ...lens_bokeh.look.splat_profile import (
    light_on_radii,
    profile_layers,
    rows_of_edge,
    rows_of_lens,
)
from ...lens_bokeh.openings.blades import BladedIris
from ...lens_bokeh.openings.masks import texel_centres
from ...lens_bokeh.openings.shapes import opening_of
from ...passes.bokeh.splat import MOST_RIMS, SPLAT_PARAMS
from .artist_tiles import artist_tiles
from .cylinder_tiles import cylinder_tiles
from .look_keys import ArraysKey, LensKey
from .real_tiles import tiles_work

# Texels along a side of the opening's layers, and of the iris masks that they are made from.
_OPENING, _MASK = 512, 1024
# Diffraction ringing depends on the size of the disc, and so on the layer; discs smaller than the
# last of these radii, px, all have the same ringing.
_RINGING_LAYERS = 4
_RINGING_MASK = 512
_REFERENCE_M = 587.5618e-9
# Largest spread of colours, px.
_FARTHEST = 1e9


@dataclass(frozen=True)
class BokehLook:
    """Shape of the discs of a frame.

    Parameters
    ----------
    variants : tuple of str
        See `passes.bokeh.splat`.
    textures : tuple of (str, GPUTexture)
        By their names in the shader.
    blocks : tuple of GPUUniformBuf
        `SplatParams`, one for each band of wavelengths that is drawn.
    field : tuple of (str, GPUUniformBuf or GPUTexture)
        Field table and `ChromaticParams`; empty without chromatic aberration.
    report : tuple of str
        Warnings: settings of the camera that cannot be met, one sentence each.
    lens : passes.surface.real_lens.LensSample or None
        The middle of the real lens that the samples see through, with its falloff; with its colours
        the first of a table for each of the `blocks`.
    """

    variants: tuple[str, ...]
    textures: tuple
    blocks: tuple
    field: tuple = ()
    report: tuple[str, ...] = ()
    lens: object = None


def describe_look(plan):
    """Compute the textures and parameters of a frame's splats, without a device.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.

    Returns
    -------
    variants : tuple of str
    arrays : dict of str to ndarray
        By the names of the textures in the shader.
    params : dict of str to sequence of float
        Members of `SplatParams`, without the wavelength.

    Raises
    ------
    AplanatError
        If the real lens cannot be focused at the camera's focus distance.
    """
    bokeh = plan.bokeh
    settings = bokeh.settings
    appearance = _appearance(settings.appearance, bokeh.iris)
    # Without ringing the opening is the same at every focus.
    ringing = appearance.diffraction is not None
    fresnel = _fresnel_scale(plan) if ringing else 0.0
    bare = replace(appearance, rims=(), edge=0.0)
    arrays = {}
    lens = bokeh.real_lens and LensKey(bokeh.real_lens)
    tangent = _largest_tangent(plan)
    params = {
        "opening": _opening_params(plan, bokeh.filter_width),
        "rows": (-1.0, 0.5, 0.0, settings.profile_strength),
        "field": (1.0 / tangent, 0.0, 1.0, 0.0),
        "rims": np.zeros((MOST_RIMS, 4)),
    }
    if _has_lens_tiles(plan) or (bokeh.artist and not bokeh.draft):
        opened = _add_tiles(plan, bare, fresnel, tangent, arrays, params)
        return ("TILES", *opened), arrays, params
    if bokeh.cylinders and not bokeh.draft:
        opened = _add_tiles(plan, bare, fresnel, _largest_tangents(plan), arrays, params)
        return ("TILES", "CYLINDERS", *opened), arrays, params
    arrays["opening_tx"] = _opening(bare, fresnel)
    variants = ()
    rows, strength = None, settings.profile_strength
    if lens is not None and strength > 0.0:
        rows = _lens_rows(lens, plan.focus_distance)
    elif lens is None and appearance.edge != 0.0:
        rows, strength = rows_of_edge(appearance.edge), 1.0
    layers = None
    if rows is not None:
        variants += ("PROFILE",)
        layers = _profile(ArraysKey(rows, arrays["opening_tx"]), strength)
        arrays["profile_tx"] = layers
        first, last = rows.w_range
        soft = rows.soft * plan.coc_scale / plan.focus_distance
        params["rows"] = (first, 1.0 / (last - first), soft, strength)
    if settings.vignetting == "ANALYTIC" and appearance.rims and not plan.orthographic:
        variants += ("RIMS",)
        rims = appearance.rims[:MOST_RIMS]
        left = _rims(rims, ArraysKey(arrays["opening_tx"], layers), tangent)
        arrays["left_tx"] = left
        params["field"] = (1.0 / tangent, len(rims), len(left) / LAYERS, 0.0)
        params["rims"][: len(rims), :3] = [(r.radius, r.shift, r.members) for r in rims]
    return variants, arrays, params


def _has_lens_tiles(plan):
    bokeh = plan.bokeh
    # A draft uses the on-axis pattern of the lens everywhere: its table is ready at once.
    return bool(
        bokeh.real_lens
        and bokeh.settings.vignetting == "LENS"
        and not plan.orthographic
        and not bokeh.draft
    )


def look_in_steps(plan):
    """Make what takes long of a look, so that `make_look` finds it.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.

    Yields
    ------
    None
        After each step.
    """
    if not _has_lens_tiles(plan):
        return
    key = LensKey(plan.bokeh.real_lens)
    work = tiles_work(key, plan.focus_distance, _largest_tangent(plan))
    # `make_look` tells what fails.
    with suppress(AplanatError):
        while work.step():
            yield


def _opening_params(plan, blur):
    bokeh = plan.bokeh
    return bokeh.iris.ratio, blur, 1.0, float(np.sqrt(len(bokeh.lens_views)))


def make_look(plan, textures, field=None, lens=None):
    """Upload the textures and parameters of a frame's splats.

    Where the real lens cannot be traced, the discs are those of a thin lens.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    textures : TextureCache
        Has those of earlier frames, which may do for this one.
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration.
    lens : passes.surface.real_lens.LensSample or None
        As of `BokehLook`.

    Returns
    -------
    BokehLook
    """
    report = ()
    try:
        variants, arrays, params = describe_look(plan)
    except AplanatError as error:
        real = plan.bokeh.real_lens
        if real is None:
            raise
        report = (f"lens '{real.prescription.name}' shapes no bokeh, a thin lens does: {error}",)
        variants, arrays, params = describe_look(
            replace(plan, bokeh=replace(plan.bokeh, real_lens=None))
        )
    uploaded = tuple((name, textures.texture(array, _texture)) for name, array in arrays.items())
    blocks = tuple(uniform_buffer(SPLAT_PARAMS.pack(**params | band)) for band in _bands(plan))
    if plan.chromatic and plan.chromatic.traced:
        # Bands have the focus and the tables of their own wavelengths: no map over the field.
        field = ()
    return BokehLook(variants, uploaded, blocks, tuple(field or ()), report, lens)


def _bands(plan):
    focus, colors = 1.0 / plan.focus_distance, plan.bokeh.colors
    if colors is None:
        nothing = (0.0, 0.0, 0.0, 0.0)
        yield {"wavelength": (1.0, 1.0, 1.0, focus), "dispersion": nothing, "spread": nothing}
        return
    for band in colors.traced:
        blur = np.hypot(plan.bokeh.filter_width, band.width_px)
        yield {
            "opening": _opening_params(plan, float(blur)),
            "wavelength": (*band.weights, focus + band.focus_change),
            "dispersion": (0.0,) * 4,
            "spread": (0.0,) * 4,
        }
    for level in colors.levels:
        for band in level.bands:
            yield {
                "wavelength": (*band.weights, focus),
                "dispersion": band.dispersion,
                "spread": (level.least, min(level.most, _FARTHEST), *colors.spreads),
            }


def _texture(array):
    if array.ndim == 4:
        return texture_array(array, "RGBA16F")
    texture = texture_2d(array, "RGBA32F")
    texture.filter_mode(True)
    texture.extend_mode("EXTEND")
    return texture


def _appearance(appearance, iris):
    """Return an appearance with the opening of the lens samples where it has none of its own."""
    if appearance.iris == BladedIris():
        appearance = replace(appearance, iris=opening_of(iris))
    if getattr(appearance.iris, "is_round", False):
        # However many blades are out of sight: a real lens' own rim is all there is.
        appearance = replace(appearance, iris=BladedIris())
    # Textures hold the opening without the anamorphic ratio, which the shader applies.
    return replace(appearance, anamorphic_ratio=1.0)


def _largest_tangent(plan):
    """Return the tangent of the field angle at the corner of the peeled raster."""
    if plan.orthographic:
        return 1.0
    inverse = np.linalg.inv(plan.bokeh.projection)
    corners = np.array([(x, y, 0.0, 1.0) for x in (-1, 1) for y in (-1, 1)]) @ inverse.T
    return float(np.hypot(corners[:, 0], corners[:, 1]).max() / -corners[0, 2])


def _largest_tangents(plan):
    """Return the tangents of the farthest fields of the peeled raster along x and y."""
    inverse = np.linalg.inv(plan.bokeh.projection)
    corners = np.array([(x, y, 0.0, 1.0) for x in (-1, 1) for y in (-1, 1)]) @ inverse.T
    return tuple((np.abs(corners[:, :2]).max(axis=0) / -corners[0, 2]).tolist())


def _fresnel_scale(plan):
    """Return the Fresnel number of a disc of one pixel radius over its radius.

    In object space ``N = a^2 |1/d - 1/d_f| / lambda``, with the radius a of the opening.
    """
    radius = float(plan.lens_extent[1])
    per_pixel = radius**2 / (plan.coc_scale * _REFERENCE_M)
    return per_pixel / (plan.focus_distance if plan.orthographic else 1.0) * plan.bokeh.filter_width


# Memos of their arguments alone, this one and those below: a picture asks for the same again and
# again, and another client of the engine for the same as well. What they return does not change.
@lru_cache(maxsize=4)
def _opening(appearance, fresnel):
    """Return the layers of the opening; `fresnel`: Fresnel number of a disc of one pixel radius."""
    ringing = appearance.diffraction
    if ringing is None or ringing.strength == 0.0:
        mask = _mask(appearance, _MASK, None)
        layers = layers_of_mask(mask, range(LAYERS), _OPENING)
    else:
        parts = []
        for layer in range(_RINGING_LAYERS):
            # The radius of the discs that read this layer, from the layer's relative blur.
            mask = _mask(appearance, _RINGING_MASK, fresnel / (LEAST_BLUR * 2.0**layer))
            last = LAYERS if layer == _RINGING_LAYERS - 1 else layer + 1
            parts.append(layers_of_mask(mask, range(layer, last), _OPENING))
        layers = np.concatenate(parts)
    areas = _texel_areas(len(layers))
    energy = layers[..., :3].sum(axis=(1, 2), dtype=np.float64) * areas[:, None]
    layers[..., :3] /= np.maximum(energy, 1e-30)[:, None, None]
    return layers


def _texel_areas(layers):
    widths = LEAST_BLUR * 2.0 ** np.arange(layers)
    return (2.0 * (1.0 + widths / np.sqrt(2.0)) / _OPENING) ** 2


def _mask(appearance, size, number):
    light = appearance.transmission(texel_centres(size), 2.0 / size, fresnel_number=number)
    return light.reshape(size, size, -1)


# Memo: see `_opening`.
@lru_cache(maxsize=4)
def _lens_rows(lens, focus_distance):
    return rows_of_lens(lens.profile(), focus_distance, lens.settings.f_number)


# Memo: see `_opening`.
@lru_cache(maxsize=4)
def _profile(rows_and_opening, strength):
    rows, opening = rows_and_opening.parts
    return profile_layers(rows, opening, strength, _light_on_radii(ArraysKey(opening)))


# Memo: see `_opening`.
@lru_cache(maxsize=4)
def _light_on_radii(opening):
    return light_on_radii(*opening.parts)


# Memo: see `_opening`.
@lru_cache(maxsize=4)
def _rims(rims, opening_and_profile, tangent):
    return splat_rims.light_left(rims, *opening_and_profile.parts, tangent)


def _add_tiles(plan, appearance, fresnel, tangent, arrays, params):
    """Add the tiles of a lens, and an opening that is not even; return the variant for that."""
    bokeh, strength = plan.bokeh, 1.0
    if bokeh.artist:
        found = artist_tiles(bokeh.artist, tangent)
    elif bokeh.cylinders:
        tables = plan.real_lens.tables
        strength = bokeh.settings.profile_strength
        found = cylinder_tiles(bokeh.cylinders, tables.aperture_radius, tables.light_grid, tangent)
    else:
        strength = bokeh.settings.profile_strength
        found = tiles_work(LensKey(bokeh.real_lens), plan.focus_distance, tangent).whole()
    tiles, (first, last), soft = found
    arrays["sharp_tx"], arrays["soft_tx"] = tiles.sharp, tiles.soft
    arrays["places_tx"] = tiles.places
    far = tiles.largest_tangent
    inverse = (1.0 / far, 0.0) if np.ndim(far) == 0 else tuple(1.0 / each for each in far)
    params["field"] = (*inverse, 1.0, 0.0)
    scale = plan.coc_scale / plan.focus_distance
    params["rows"] = (first, 1.0 / (last - first), soft * scale, strength)
    if appearance == type(appearance)():
        return ()
    opening = arrays["opening_tx"] = _opening(appearance, fresnel)
    arrays["left_tx"] = _tiles_left(ArraysKey(tiles, opening), bool(bokeh.cylinders))
    return ("OPENED",)


# Memo: see `_opening`.
@lru_cache(maxsize=2)
def _tiles_left(tiles_and_opening, even):
    if even:
        return np.ones((1, 2, 2, 4), np.float32)
    return splat_pupil.light_left(*tiles_and_opening.parts)
