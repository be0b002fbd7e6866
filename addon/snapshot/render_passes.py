"""The table of render passes: their names, contents, and how each is made.

Blender names the sockets of the compositor, the render result and the parts of a multilayer EXR
after this table, in its order. Which of them a view layer asks for is read by `scene.settings`: by
Blender's own switch, or by the setting of ours whose `field` is the pass
(`settings.scene_settings.PASSES`).

- **Combined** is the picture through the lens: the sum of **Defocus**, the light of the lens
  samples, and **Bokeh**, the highlights that were splatted, to the last bit.
- **Depth, Normal, Position, Vector, CoC** describe what a pinhole at the lens' centre sees in the
  middle of each pixel: unblurred, without pixel filter. Depth runs along the optical axis and is
  1e10 where nothing is; Position and Normal are in world space, the normal turned towards the
  camera; Vector holds the movement since the previous frame and to the next in pixels, with
  Cycles' signs. CoC is the signed radius of the circle of confusion in pixels, negative in front of
  the focus plane.
- **Detail** shows where the adaptive method saves work: the object's level of detail, the share of
  the lens samples that copy a drawing of it, and 1 where there is an object.
- **Sample Count** is the number of lens samples that a pixel got.
- **Focus Matte** and the **Cryptomattes** are seen through the lens, so that they fit the blurred
  edges of Combined. Focus Matte is the share of a pixel that sharp surfaces fill; see
  `engine.planning.plan.sharp_radius`. As CoC, it uses the focus of the reference wavelength.
- **Fringe** is Combined less the same picture without chromatic aberration; it may be negative, and
  costs a second picture.
"""

import re
from dataclasses import dataclass

_CRYPTOMATTE = re.compile(r"Crypto(Object|Material)\d\d")


@dataclass(frozen=True)
class RenderPass:
    """One pass.

    Parameters
    ----------
    name : str
        Blender's name where Blender has one.
    channels : str
        A letter each; ``RGBA`` in capitals are colours, which files may hold in half precision.
    kind : {'COLOR', 'VALUE', 'VECTOR'}
        How the compositor reads it.
    maker : {'COLOR', 'DATA', 'MATTE', 'CRYPTOMATTE'}
        `COLOR`: the sum of the lens samples. `DATA`: one pinhole pass. `MATTE` and `CRYPTOMATTE`:
        gathered beside the lens samples.
    blenders_switch : str
        Property of Blender's view layer that asks for the pass; empty where a setting of ours does,
        and for Combined, which is always made.
    """

    name: str
    channels: str
    kind: str
    maker: str
    blenders_switch: str = ""


PASSES = {
    entry.name: entry
    for entry in (
        RenderPass("Combined", "RGBA", "COLOR", "COLOR"),
        RenderPass("Defocus", "RGBA", "COLOR", "COLOR"),
        RenderPass("Bokeh", "RGBA", "COLOR", "COLOR"),
        RenderPass("Depth", "Z", "VALUE", "DATA", "use_pass_z"),
        RenderPass("Normal", "XYZ", "VECTOR", "DATA", "use_pass_normal"),
        RenderPass("Position", "XYZ", "VECTOR", "DATA", "use_pass_position"),
        RenderPass("Vector", "XYZW", "VECTOR", "DATA", "use_pass_vector"),
        RenderPass("CoC", "X", "VALUE", "DATA"),
        RenderPass("Detail", "XYZ", "VECTOR", "DATA"),
        RenderPass("Focus Matte", "X", "VALUE", "MATTE"),
        RenderPass("Fringe", "RGB", "COLOR", "COLOR"),
        RenderPass("Sample Count", "X", "VALUE", "COLOR"),
    )
}


def render_pass(name):
    """Return the pass called `name`.

    Raises
    ------
    KeyError
        If Aplanat makes no such pass.
    """
    if _CRYPTOMATTE.fullmatch(name):
        # In capitals Blender takes ids for colours and stores them in half precision at depth 16.
        return RenderPass(name, "rgba", "COLOR", "CRYPTOMATTE")
    return PASSES[name]


def made_by(names, *makers):
    """Return those of the named passes that one of the makers makes, in order."""
    return tuple(name for name in names if render_pass(name).maker in makers)


def cryptomatte_kinds(names):
    """Return how many passes each kind of Cryptomatte has among the named ones.

    Returns
    -------
    dict of str to int
        Keys ``"CryptoObject"`` and ``"CryptoMaterial"``, where present.
    """
    counts = {}
    for name in made_by(names, "CRYPTOMATTE"):
        counts[name[:-2]] = counts.get(name[:-2], 0) + 1
    return counts
