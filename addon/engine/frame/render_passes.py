"""Render passes as Blender is told of them, and given their pictures.

What passes there are says `snapshot.render_passes`.
"""

import json

from ...snapshot.cryptomatte import cryptomatte_hash, murmur3_32
from ...snapshot.render_passes import cryptomatte_kinds, render_pass


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
