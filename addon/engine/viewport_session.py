"""The session of 3D views that show the same objects: their scene content and its buffers."""

from functools import cache

from ..device import context as device_context
from ..levels.choosing import meshes_with_levels
from .session import RenderSession


class ViewportSession(RenderSession):
    """The scene content of one or several 3D views, and its buffers on the device.

    Parameters
    ----------
    shared : SharedResources
    space : bpy.types.SpaceView3D or None
        A 3D view in local view or with collections of its own; None for all others.

    Attributes
    ----------
    scene_buffers : SceneBuffers
    levels : LevelHandle
    """

    def __init__(self, shared, space):
        super().__init__(shared)
        self.scene_buffers = self.buffers()
        self._extractor = self.extractor(space, device_context.max_texture_size())
        # The handle closes itself when no 3D view shows the scene any more.
        self.levels = self.open_levels()
        self._wanted = set()
        self._least_triangles = None
        self._generation = self.levels.generation

    def note_updates(self, depsgraph):
        """Take note of what changed, as `SceneExtractor.note_updates`."""
        self._extractor.note_updates(depsgraph)

    def content(self, depsgraph):
        """Return the current `SceneContent`, after its upload."""
        # As the viewport's sampling: of the original scene, which has what was just set.
        shadows = depsgraph.scene.aplanat.use_shadows
        content = self._extractor.extract_content(depsgraph, shadows=shadows)
        self.scene_buffers.update(content)
        return content

    def want_levels(self, content, plan):
        """Request the levels of detail that a frame draws."""
        self._wanted.update(meshes_with_levels(content, plan))
        self._wanted &= content.meshes.keys()
        if plan.least_triangles != self._least_triangles:
            self._least_triangles = plan.least_triangles
            self.scene_buffers.drop_levels()
        if self._generation != self.levels.generation:
            self._generation = self.levels.generation
            self.scene_buffers.drop_levels()
        if self._missing():
            self.levels.request(
                [mesh for uid, mesh in content.meshes.items() if uid in self._wanted],
                plan.least_triangles,
            )
            for uid in sorted(self._missing()):
                levels = self.levels.ready(uid)
                # Until they are made, full detail is drawn.
                if levels is not None:
                    self.scene_buffers.add_levels(uid, levels)

    def levels_changed(self, version):
        """Whether a picture has to start again because its levels of detail have changed.

        Parameters
        ----------
        version : int
            `SceneBuffers.levels_version` when it started.

        Returns
        -------
        bool
            All missing levels have been made since, or those it used are out of date.
        """
        if self._generation != self.levels.generation:
            return True
        missing = self._missing()
        if not missing:
            return version != self.scene_buffers.levels_version
        return all(self.levels.ready(uid) is not None for uid in missing)

    def _missing(self):
        return self._wanted - self.scene_buffers.levels.keys()


def session_of_view(shared, depsgraph, space):
    """Return the session of a 3D view, which it has with those that show the same objects.

    Parameters
    ----------
    shared : SharedResources
    depsgraph : bpy.types.Depsgraph
    space : bpy.types.SpaceView3D

    Returns
    -------
    ViewportSession
        Opened if there is none; it ends when nobody has it any more.
    """
    key, filtering = _visibility_key(space)
    layer = depsgraph.view_layer
    key = (depsgraph.as_pointer(), depsgraph.scene.original.session_uid, layer.name, *key)
    session = shared.views.get(key)
    if session is None:
        session = shared.views[key] = ViewportSession(shared, space if filtering else None)
    return session


def _visibility_key(space):
    shown = tuple(getattr(space, name) for name in _type_switches(type(space)))
    if space.local_view is None and not space.use_local_collections and all(shown):
        return (), False
    return (space.as_pointer(), space.local_view is None, space.use_local_collections, *shown), True


# Memo of Blender's type alone.
@cache
def _type_switches(space_type):
    names = space_type.bl_rna.properties.keys()
    return tuple(name for name in names if name.startswith("show_object_viewport_"))
