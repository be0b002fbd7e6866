"""Blender's own panels that are shown while Aplanat is the render engine.

A panel names the engines it is for in `COMPAT_ENGINES`. Those for the generic engine
``BLENDER_RENDER`` fit, except for those of features that Aplanat lacks; a few of EEVEE's fit too.
"""

import bpy

from ...engine.render_engine import ENGINE_ID

GENERIC_ENGINE = "BLENDER_RENDER"

# Panels of EEVEE over properties that Aplanat reads.
_ADDED = frozenset(
    {
        "DATA_PT_camera_dof",
        "DATA_PT_camera_dof_aperture",
        "DATA_PT_EEVEE_light",
        "NODE_DATA_PT_EEVEE_light",
        "EEVEE_MATERIAL_PT_context_material",
        "EEVEE_MATERIAL_PT_displacement",
        "EEVEE_MATERIAL_PT_surface",
        "EEVEE_MATERIAL_PT_volume",
        "EEVEE_WORLD_PT_surface",
        "VIEWLAYER_PT_layer_passes",
    }
)
# Generic panels over properties that it does not read, or for which it has its own.
_LEFT_OUT = frozenset(
    {
        # The light panels of EEVEE, in its place, know temperature and exposure.
        "DATA_PT_light",
        "NODE_DATA_PT_light",
        "DATA_PT_preview",
        "DATA_PT_volume_render",
        "OBJECT_PT_shading",
    }
)
# Light probes; of Simplify there is one in its place.
_LEFT_OUT_WORDS = ("lightprobe", "RENDER_PT_simplify")


def fitting_panels():
    """Return the classes of Blender's panels that fit, as they are registered now."""
    return [panel for panel in subclasses(bpy.types.Panel) if _fits(panel)]


def subclasses(base):
    """Yield the subclasses of a class, and theirs."""
    for cls in base.__subclasses__():
        yield cls
        yield from subclasses(cls)


def _fits(panel):
    engines = getattr(panel, "COMPAT_ENGINES", None)
    if not isinstance(engines, set):
        return False
    name = panel.__name__
    if name in _ADDED:
        return True
    wanted = name not in _LEFT_OUT and not any(word in name for word in _LEFT_OUT_WORDS)
    return wanted and GENERIC_ENGINE in engines


def register():
    """Show the panels for Aplanat."""
    for panel in fitting_panels():
        panel.COMPAT_ENGINES.add(ENGINE_ID)


def unregister():
    """Undo `register`."""
    for panel in fitting_panels():
        panel.COMPAT_ENGINES.discard(ENGINE_ID)
