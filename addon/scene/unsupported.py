"""Warnings about settings of a whole scene that Aplanat does not support.

Settings of the scene, the view layer, the world and the camera that Cycles or EEVEE obey, and
libraries, fonts and caches that are missing. Warnings about objects, lights, materials and images
are made where these are read. Features that are missing in every scene (shadows, bounced light) are
in the documentation instead: a warning that is always there would be ignored.
"""

import os

import bpy

# Most names in a warning; beyond, their number is given.
_LISTED = 3

# Blender's switches of passes that Aplanat offers, or that are not passes.
_OFFERED = {
    "use_pass_combined",
    "use_pass_z",
    "use_pass_vector",
    "use_pass_position",
    "use_pass_normal",
    "use_pass_cryptomatte_object",
    "use_pass_cryptomatte_material",
    # A choice of how Cycles accumulates Cryptomattes, not a pass.
    "use_pass_cryptomatte_accurate",
    # Made by Blender itself, for grease pencil.
    "use_pass_grease_pencil",
}
# Passes of Cycles whose switches do not have the prefix of the others.
_PASSES_OF_CYCLES = {
    "pass_debug_sample_count": "Sample Count",
    "pass_render_time": "Render Time",
    "denoising_store_passes": "Denoising Data",
}


def read_unsupported(depsgraph):
    """Return the warnings about a scene as a whole.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph

    Returns
    -------
    list of str
        One line each, which names the data-block.
    """
    scene = depsgraph.scene
    lines = missing_links() + missing_files()
    lines += [f"scene '{scene.name}': {what}" for what in _of_scene(depsgraph)]
    lines += _of_camera(depsgraph.scene_eval)
    layer = depsgraph.view_layer
    lines += [f"view layer '{layer.name}': {what}" for what in _of_layer(layer)]
    world = depsgraph.view_layer_eval.world_override or depsgraph.scene_eval.world
    if world is not None and layer.use_sky:
        lines += [f"world '{world.name_full}': {what}" for what in _of_world(world)]
    return lines


def missing_links():
    """Return a warning for each library that is missing or lacks what is linked from it.

    Returns
    -------
    list of str
    """
    if not bpy.data.libraries:
        return []
    lost = {}
    for block in _linked_blocks():
        if block.is_missing:
            name = f"{type(block).__name__.lower()} '{block.name}'"
            # Some kinds have two collections in bpy.data.
            lost.setdefault(block.library, {})[name] = None
    lines = []
    for library in bpy.data.libraries:
        names = [*lost.get(library, ())]
        if library.is_missing:
            told = f" ({_listed(names)})" if names else ""
            lines.append(
                f"library '{library.filepath}' cannot be read; what is linked from it is missing"
                f"{told}"
            )
        elif names:
            lines.append(f"library '{library.filepath}' lacks what is linked: {_listed(names)}")
    return lines


def missing_files():
    """Return a warning for each font and each cache of geometry whose file is missing.

    Images tell for themselves, because only those that are drawn count.

    Returns
    -------
    list of str
    """
    lines = []
    for font in bpy.data.fonts:
        if font.users and not font.packed_file and _is_missing(font):
            lines.append(
                f"font '{font.name}' ({font.filepath}) cannot be read; Blender's own is used"
            )
    for cache in bpy.data.cache_files:
        # A sequence has no file of the name itself.
        if cache.users and not cache.is_sequence and _is_missing(cache):
            lines.append(
                f"cache file '{cache.name}' ({cache.filepath}) cannot be read; what is in it is"
                " missing or stands still"
            )
    return lines


def _is_missing(block):
    # Blender's built-in font.
    if block.filepath in {"", "<builtin>"}:
        return False
    return not os.path.isfile(bpy.path.abspath(block.filepath, library=block.library))


def _linked_blocks():
    for prop in bpy.types.BlendData.bl_rna.properties:
        if prop.type != "COLLECTION" or prop.identifier == "libraries":
            continue
        for block in getattr(bpy.data, prop.identifier):
            if block.library is not None:
                yield block


def _of_scene(depsgraph):
    scene = depsgraph.scene_eval
    render = scene.render
    if render.use_motion_blur and depsgraph.view_layer.use_motion_blur:
        yield "motion blur is not drawn; everything is where it is at the frame itself"
    # Without the add-on the scene has no settings of Cycles.
    cycles = getattr(scene, "cycles", None)
    if cycles is not None:
        if cycles.film_exposure != 1.0:
            yield f"the film exposure of Cycles, {cycles.film_exposure:g}, is not applied"
        if render.use_simplify and cycles.use_distance_cull:
            yield "distance culling of Cycles is not done; objects far away are drawn"


def _of_camera(scene):
    render, camera = scene.render, scene.camera
    if not (render.use_multiview and render.views_format == "STEREO_3D"):
        return
    if camera is not None and camera.type == "CAMERA" and camera.data.stereo.use_spherical_stereo:
        yield (
            f"camera '{camera.name_full}': spherical stereo is not drawn; both eyes look ahead from"
            " where they are"
        )


def _of_layer(layer):
    missing = _passes_not_offered(layer)
    if missing:
        yield f"passes that Aplanat does not offer are left out: {', '.join(missing)}"


def _passes_not_offered(layer):
    owners = [layer, *(getattr(layer, name, None) for name in ("cycles", "eevee"))]
    found = []
    for owner in filter(None, owners):
        for prop in owner.bl_rna.properties:
            key = prop.identifier
            named = _PASSES_OF_CYCLES.get(key) if owner is not layer else None
            is_pass = key.startswith("use_pass_") and key not in _OFFERED
            if (named or is_pass) and prop.type == "BOOLEAN" and getattr(owner, key):
                found.append(named or prop.name)
    found += [f"AOV '{aov.name}'" for aov in layer.aovs]
    found += [f"light group '{group.name}'" for group in layer.lightgroups]
    # Cycles and EEVEE have switches of the same pass.
    return dict.fromkeys(found)


def _of_world(world):
    visibility = getattr(world, "cycles_visibility", None)
    if visibility is None:
        return
    hidden = [name for name in ("camera", "diffuse", "glossy") if not getattr(visibility, name)]
    if hidden:
        yield f"its ray visibility ({', '.join(hidden)}) is not heeded; it is seen and lights"


def _listed(names):
    more = len(names) - _LISTED
    listed = ", ".join(names[:_LISTED])
    return f"{listed} and {more} more" if more > 0 else listed
