"""The table of render passes: their names, contents, and how each is made.

Blender names the sockets of the compositor, the render result and the parts of a multilayer EXR
after this table, and asks for the passes of a view layer through `register`.

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

import json
import re
from dataclasses import dataclass

from ...snapshot.cryptomatte import cryptomatte_hash, murmur3_32

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
    """

    name: str
    channels: str
    kind: str
    maker: str


_TABLE = {
    render_pass.name: render_pass
    for render_pass in (
        RenderPass("Combined", "RGBA", "COLOR", "COLOR"),
        RenderPass("Defocus", "RGBA", "COLOR", "COLOR"),
        RenderPass("Bokeh", "RGBA", "COLOR", "COLOR"),
        RenderPass("Depth", "Z", "VALUE", "DATA"),
        RenderPass("Normal", "XYZ", "VECTOR", "DATA"),
        RenderPass("Position", "XYZ", "VECTOR", "DATA"),
        RenderPass("Vector", "XYZW", "VECTOR", "DATA"),
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
    return _TABLE[name]


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


def cryptomatte_metadata(snapshot):
    """Return what a picture says about its Cryptomattes, so that names can be picked.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    dict of str to str
        Keys as the Cryptomatte specification demands them, for each kind that is asked for.
    """
    content = snapshot.content
    names = {
        "CryptoObject": content.instances.names,
        "CryptoMaterial": [material.name for material in content.materials.values()],
    }
    metadata = {}
    for kind in cryptomatte_kinds(snapshot.passes):
        name = f"{snapshot.layer_name}.{kind}"
        prefix = f"cryptomatte/{murmur3_32(name.encode()):08x}"[: len("cryptomatte/") + 7]
        manifest = {n: f"{cryptomatte_hash(n):08x}" for n in sorted(set(names[kind])) if n}
        metadata |= {
            f"{prefix}/name": name,
            f"{prefix}/hash": "MurmurHash3_32",
            f"{prefix}/conversion": "uint32_to_float32",
            f"{prefix}/manifest": json.dumps(manifest, ensure_ascii=False, separators=(",", ":")),
        }
    return metadata


def register(engine, scene, view_layer, names):
    """Tell Blender which passes a view layer will have.

    Parameters
    ----------
    engine : bpy.types.RenderEngine
    scene : bpy.types.Scene
    view_layer : bpy.types.ViewLayer
    names : sequence of str
        As `scene.settings.read_passes` gives them.
    """
    for entry in map(render_pass, names):
        engine.register_pass(
            scene, view_layer, entry.name, len(entry.channels), entry.channels, entry.kind
        )


def fill_layer(layer, pictures):
    """Copy pictures into a layer of a render result.

    Parameters
    ----------
    layer : bpy.types.RenderLayer
    pictures : dict of str to ndarray of shape (height, width, channels)
        float32, bottom row first, by pass; those that the layer lacks are left out.
    """
    for name, picture in pictures.items():
        # Blender drops a pass between registering and rendering when a script changes the layer.
        target = layer.passes.get(name)
        if target is not None:
            target.rect.foreach_set(picture.reshape(-1))
