"""The occluders of a scene: opaque triangles, and transparent surfaces."""

from functools import cached_property

from ...passes.nodes import surface_code
from ...passes.surface import surface
from ...passes.visibility import cones, visibility_raster
from ..drawing.occluders import Occluders, Part


class SceneOccluders:
    """The occluders of a scene on the device.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
        Updated to it.

    Attributes
    ----------
    groups : tuple of passes.visibility.cones.GroupRange
        Groups of instances with a transparent surface.
    """

    def __init__(self, content, buffers):
        self._content = content
        self._buffers = buffers
        self._groups = [group for group in content.groups if any(self._see_through(group).values())]
        self.groups = tuple(
            cones.GroupRange(
                group.first, group.first + group.count - 1, content.meshes[group.mesh].bounds
            )
            for group in self._groups
        )

    def _see_through(self, group):
        """Return which material slots of a group's mesh are transparent, dict of slot to bool."""
        mesh = self._content.meshes[group.mesh]
        return {
            slot: not group.holdout
            and surface_code.generate(
                self._content.materials[group.materials[slot]].graph, mesh.attributes
            ).transparent
            for slot, _, _ in mesh.slots
        }

    @cached_property
    def opaque(self):
        """The opaque triangles, as `Occluders`."""
        cache, parts, same = self._buffers.shapes, [], {}
        for group in self._content.groups:
            meshes = self._buffers.level_meshes(self._content.meshes[group.mesh])
            for slot, see_through in self._see_through(group).items():
                if see_through:
                    continue
                key = (group.mesh, slot)
                if key not in same:
                    shapes = [cache.shape(mesh, slot) for mesh in meshes]
                    # A level may lack a slot that has only few triangles.
                    same[key] = tuple(s for s in shapes if s is not None)
                if same[key]:
                    parts.append(Part(group.first, group.count, same[key]))
        return Occluders(parts, self._content.instances.world, cache)

    @cached_property
    def _draws(self):
        draws = surface.build_draws(self._content, self._buffers, visibility_raster.TARGET)
        return [draw for draw in draws if draw.level == 0 and draw.constants is not None]

    def draws_of(self, number):
        """Return the draws of the transparent surfaces of a group."""
        group = self._content.groups.index(self._groups[number])
        return [draw for draw in self._draws if draw.group == group]
