"""From Blender's evaluated scene to a `SceneSnapshot`."""

from dataclasses import dataclass, replace

import numpy as np

from ..snapshot.changes import Change, compare_content, same_instances
from ..snapshot.content import InstanceGroup, InstanceTable, SceneContent
from ..snapshot.cryptomatte import cryptomatte_id
from ..snapshot.scene import SceneSnapshot
from ..snapshot.surface_graph import attributes_read
from .camera.camera import CameraSources, read_camera
from .camera.drawn_curves import is_curve_group
from .geometry.instances import read_instances
from .geometry.meshes import EarlierMeshes, MeshReading, read_mesh, used_slots
from .geometry.motion import RowSources, add_motion
from .settings import read_film, read_passes, read_sampling
from .shading.materials import MaterialReader
from .shading.world import read_world
from .unsupported import read_unsupported


@dataclass(frozen=True, eq=False)
class _KnownMesh:
    """A mesh that was read, the attributes asked for, and the data-blocks that it was made from."""

    reading: MeshReading
    keys: frozenset[str]
    owners: frozenset[int]


class SceneExtractor:
    """Extracts snapshots, keeping the parts that did not change between two of them.

    An extractor belongs to one depsgraph. Between two extractions `note_updates` must be called
    for every update of that depsgraph.

    Data-blocks that an update names are read again, and what is equal bit by bit keeps its
    identity: an update that changes nothing in the picture gives the identical `SceneContent`. A
    mesh is taken from the cache only if Blender gives the same session number for its evaluated
    state and no update named a data-block that it was made from; pointers are never compared.

    Parameters
    ----------
    space : bpy.types.SpaceView3D or None
        The 3D view whose local view and collections apply.
    largest_image : int or None
        Texels along a side that the device can hold.
    in_main_thread : callable or None
        As for `scene.images.images.ImageReader`; for an extractor that is used in another thread.
    sources : CameraSources or None
        Of the session; None: its own.
    """

    def __init__(self, space=None, largest_image=None, in_main_thread=None, sources=None):
        self._space = space
        self._camera_sources = sources or CameraSources()
        self._materials = MaterialReader(largest_image, in_main_thread)
        self._known = {}
        # Meshes read before whose source may have changed: compared with what is read next.
        self._doubtful = []
        self._content = None
        self._asked = None
        self._stale = True
        self._sources = None

    def note_updates(self, depsgraph):
        """Note the changes that Blender reports since the last evaluation.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        """
        changed = set()
        for update in depsgraph.updates:
            block = update.id.original
            if _is_camera(block) or is_curve_group(block):
                continue
            self._stale = True
            if type(block).__name__ == "Image":
                self._materials.image_reader.note_change(block.session_uid)
            if update.is_updated_geometry:
                changed.add(block.session_uid)
        self._doubt([key for key, known in self._known.items() if known.owners & changed])

    def _doubt(self, keys):
        self._doubtful += [self._known.pop(key).reading for key in keys]

    def look_again(self, meshes=False):
        """Have the next extraction read all again, the meshes only if `meshes`."""
        self._stale = True
        self._materials.image_reader.is_told = False
        if meshes:
            self._doubt(list(self._known))

    def extract(self, depsgraph, frame_set=None, view=None):
        """Return the snapshot of an evaluated scene for its view layer.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        frame_set : callable or None
            ``frame_set(frame, subframe)`` of the render engine. With it, and only where the Vector
            pass is on, the neighbouring frames are evaluated too.
        view : engine.views.View or None
            Whose camera takes the picture, in a stereoscopic render.

        Returns
        -------
        SceneSnapshot

        Raises
        ------
        InputError
            If the scene, its camera or its settings cannot be rendered.
        """
        scene, view_layer = depsgraph.scene, depsgraph.view_layer
        film = read_film(scene)
        passes, sampling = read_passes(view_layer), read_sampling(depsgraph.scene_eval)
        snapshot = SceneSnapshot(
            camera=read_camera(depsgraph, scene.camera, film, view, self._camera_sources),
            content=self.extract_content(depsgraph, passes, sampling.shadows),
            film=film,
            sampling=sampling,
            passes=passes,
            layer_name=view_layer.name,
            alpha_threshold=view_layer.pass_alpha_threshold,
        )
        if "Vector" in passes and frame_set is not None:
            snapshot = add_motion(snapshot, self._sources, depsgraph, frame_set, view)
            # The caches describe an evaluation that is gone.
            self._known, self._doubtful, self._content, self._stale = {}, [], None, True
        return snapshot

    def extract_content(self, depsgraph, passes=("Combined",), shadows=False):
        """Return the content of the scene; the identical object if nothing changed.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        passes : tuple of str
            Decides which mesh attributes and names are needed beside those of the surfaces.
        shadows : bool
            Of the sampling; with them, what only throws shadows is read, too.

        Returns
        -------
        SceneContent
        """
        asked = passes, shadows
        if self._content is not None and not self._stale and asked == self._asked:
            return self._content
        content = self._read_content(depsgraph, *asked)
        if compare_content(self._content, content) is not Change.NONE:
            self._content = content
        self._asked = asked
        self._stale = False
        return self._content

    def _read_content(self, depsgraph, passes, shadows):
        for_motion = "Vector" in passes
        found = read_instances(depsgraph, self._space, shadows, with_places=for_motion)
        materials = self._materials
        materials.begin()
        slots_of = {}
        for key, source in found.sources.items():
            if slots := self._used_slots(depsgraph, source):
                slots_of[key] = slots
        uids_of = {
            look: _slot_uids(found.slots[look.slots], slots_of[look.mesh], materials)
            for look in dict.fromkeys(found.looks)
            if look.mesh in slots_of
        }
        needed = _needed_attributes(uids_of, slots_of, materials.materials, passes)
        readings = self._read_meshes(depsgraph, found, needed, for_motion)
        seen = {look: uids for look, uids in uids_of.items() if look.camera}
        order, groups = _rows_and_groups(found.looks, seen, readings)
        meshes = _meshes_of(groups, readings)
        if for_motion:
            self._sources = RowSources(
                places=[found.places[i] for i in order],
                meshes=[readings[found.looks[i].mesh].snapshot.uid for i in order],
                readings={reading.snapshot.uid: reading for reading in readings.values()},
                keys={reading.snapshot.uid: key for key, reading in readings.items()},
            )
        notes = [note for reading in readings.values() for note in reading.notes]
        world, world_notes = read_world(_world_of(depsgraph), materials.image_reader)
        return SceneContent(
            meshes=meshes,
            images=materials.images,
            materials=materials.materials,
            instances=self._instance_table(found, order, passes),
            groups=groups,
            unseen=self._unseen(found, uids_of, readings, passes),
            lights=tuple(found.lights),
            world=world,
            report=tuple(
                dict.fromkeys(
                    [
                        *read_unsupported(depsgraph),
                        *found.report,
                        *notes,
                        *world_notes,
                        *materials.report,
                    ]
                )
            ),
        )

    def _unseen(self, found, uids_of, readings, passes):
        """Return the content that only hides light, or None."""
        uids_of = {look: uids for look, uids in uids_of.items() if not look.camera}
        if not uids_of:
            return None
        order, groups = _rows_and_groups(found.looks, uids_of, readings)
        used = {uid for group in groups for uid in group.materials}
        materials = {u: m for u, m in self._materials.materials.items() if u in used}
        return SceneContent(
            meshes=_meshes_of(groups, readings),
            images=self._materials.images,
            materials=materials,
            instances=self._instance_table(found, order, passes),
            groups=groups,
        )

    def _instance_table(self, found, order, passes):
        names = [found.names[i] for i in order]
        with_names = any(name.startswith("Crypto") for name in passes)
        table = InstanceTable(
            world=np.take(found.world, np.array(order, np.intp), axis=0),
            cryptomatte_id=np.array([cryptomatte_id(name) for name in names], np.float32),
            names=tuple(names) if with_names else (),
            looks=np.take(found.object_values, np.array(order, np.intp), axis=0),
        )
        if self._content is not None and same_instances(self._content.instances, table):
            return self._content.instances
        return table

    def _used_slots(self, depsgraph, source):
        known = self._known.get(source.key)
        if known is not None:
            return tuple(slot for slot, _, _ in known.reading.snapshot.slots)
        with source.opened(depsgraph) as mesh:
            return used_slots(mesh)

    def _read_meshes(self, depsgraph, found, needed, for_motion):
        current = {}
        earlier = [*self._doubtful]
        earlier += [k.reading for key, k in self._known.items() if key not in needed]
        earlier = EarlierMeshes(reading.snapshot for reading in earlier)
        for key, keys in needed.items():
            source, known = found.sources[key], self._known.get(key)
            if (
                known is None
                or not keys <= known.keys
                or (for_motion and known.reading.split is None)
            ):
                with source.opened(depsgraph) as mesh:
                    reading = read_mesh(mesh, keys, source.owner, source.base, source.carried)
                equal = earlier.take_equal(reading.snapshot)
                split = reading.split if for_motion else None
                reading = replace(reading, snapshot=equal, split=split)
                known = _KnownMesh(reading, keys, frozenset(found.owners[key]))
            current[key] = known
        self._known = {key: known for key, known in current.items() if isinstance(key, int)}
        self._doubtful = [k.reading for key, k in current.items() if key not in self._known]
        return {key: known.reading for key, known in current.items()}


def _needed_attributes(uids_of, slots_of, materials, passes):
    """Return the attributes that the surfaces on each mesh, or the passes, read."""
    of_passes = {"normal"} if "Normal" in passes else set()
    needed = {look.mesh: of_passes.copy() for look in uids_of}
    for look, uids in uids_of.items():
        if not look.holdout:
            for slot in slots_of[look.mesh]:
                needed[look.mesh] |= attributes_read(materials[uids[slot]].graph)
    return {key: frozenset(keys) for key, keys in needed.items()}


def _rows_and_groups(row_looks, uids_of, readings):
    """Return the rows with one of the looks in the order of groups, and the groups."""
    order, counts = _sort_rows(row_looks, list(uids_of))
    groups, first = [], 0
    for (look, uids), count in zip(uids_of.items(), counts, strict=True):
        mesh = readings[look.mesh].snapshot.uid
        groups.append(InstanceGroup(mesh, uids, first, count, look.holdout, look.shadow))
        first += count
    return order, tuple(groups)


def _meshes_of(groups, readings):
    used = {group.mesh for group in groups}
    found = (reading.snapshot for reading in readings.values())
    return {mesh.uid: mesh for mesh in found if mesh.uid in used}


def _sort_rows(row_looks, looks):
    """Return the rows with one of `looks`, sorted by it, and how many each has."""
    numbers = {look: i for i, look in enumerate(looks)}
    number = np.array([numbers.get(look, -1) for look in row_looks], np.int64)
    counts = np.bincount(number + 1, minlength=len(looks) + 1)
    order = np.argsort(number, kind="stable")[counts[0] :]
    return order.tolist(), counts[1:].tolist()


def _slot_uids(slots, used, materials):
    """Return a material for every slot up to the last that is used, reading only used ones."""
    # As in Blender, a face whose slot does not exist has the last one.
    uids = {slot: materials.read(slots[min(slot, len(slots) - 1)]) for slot in used}
    top = max(used, default=-1)
    return tuple(uids.get(slot, uids[top]) for slot in range(top + 1))


def _is_camera(block):
    kind = type(block).__name__
    return kind == "Camera" or (kind == "Object" and block.type == "CAMERA")


def _world_of(depsgraph):
    """Return the evaluated world that a view layer shows, or None."""
    view_layer = depsgraph.view_layer_eval
    if not view_layer.use_sky:
        return None
    return view_layer.world_override or depsgraph.scene_eval.world
