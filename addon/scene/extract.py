"""From Blender's evaluated scene to a `SceneSnapshot`."""

from dataclasses import dataclass, replace

import numpy as np

from .camera import read_camera
from .changes import Change, compare_content, same_instances
from .cryptomatte import cryptomatte_id
from .instances import read_instances
from .materials import MaterialReader
from .meshes import MeshReading, read_mesh, same_content, used_slots
from .motion import RowSources, add_motion
from .settings import read_film, read_passes, read_sampling
from .snapshot import InstanceGroup, InstanceTable, SceneContent, SceneSnapshot, World
from .surface_graph import attributes_read


@dataclass(frozen=True, eq=False)
class _KnownMesh:
    """A mesh that was read, which attributes were asked for, and what it was made from."""

    reading: MeshReading
    keys: frozenset[str]
    owners: frozenset[int]


class SceneExtractor:
    """Extracts snapshots, keeping the parts that did not change between two of them.

    An extractor belongs to one depsgraph. Between two extractions it must be told of every update
    of that depsgraph by `note_updates`; one that is used once needs no telling.

    What an update names is read again, and what comes out equal, bit by bit, keeps its identity:
    an update that changes nothing in the picture gives the very same `SceneContent`. A mesh is
    taken from the cache only if Blender still gives the number of that evaluated state and no
    update named one of the data-blocks it was made from; pointers are never compared.

    Parameters
    ----------
    space : bpy.types.SpaceView3D or None
        The 3D view whose local view and collections apply.
    """

    def __init__(self, space=None):
        self._space = space
        self._materials = MaterialReader()
        self._known = {}
        # Read before, but the source may have changed: compared with what is read next.
        self._doubtful = []
        self._content = None
        self._passes = None
        self._stale = True
        self._sources = None

    def note_updates(self, depsgraph):
        """Take note of what Blender says changed since the last evaluation.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        """
        changed = set()
        for update in depsgraph.updates:
            block = update.id.original
            if _is_camera(block):
                continue
            self._stale = True
            if update.is_updated_geometry:
                changed.add(block.session_uid)
        for key in [key for key, known in self._known.items() if known.owners & changed]:
            self._doubtful.append(self._known.pop(key).reading)

    def extract(self, depsgraph, frame_set=None):
        """Return the snapshot of an evaluated scene for its view layer.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        frame_set : callable or None
            ``frame_set(frame, subframe)`` of the render engine. With it, and only where the Vector
            pass is on, the neighbouring frames are evaluated too.

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
        passes = read_passes(view_layer)
        snapshot = SceneSnapshot(
            camera=read_camera(depsgraph, scene.camera, film),
            content=self.extract_content(depsgraph, passes),
            film=film,
            sampling=read_sampling(scene),
            passes=passes,
            layer_name=view_layer.name,
            alpha_threshold=view_layer.pass_alpha_threshold,
        )
        if "Vector" in passes and frame_set is not None:
            snapshot = add_motion(snapshot, self._sources, depsgraph, frame_set)
            # What is known describes an evaluation that is gone.
            self._known, self._doubtful, self._content, self._stale = {}, [], None, True
        return snapshot

    def extract_content(self, depsgraph, passes=("Combined",)):
        """Return what stands in front of the camera; the same object if nothing changed.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        passes : tuple of str
            Decides which mesh attributes and names are needed beside those of the surfaces.

        Returns
        -------
        SceneContent
        """
        if self._content is not None and not self._stale and passes == self._passes:
            return self._content
        content = self._read_content(depsgraph, passes)
        if compare_content(self._content, content) is not Change.NONE:
            self._content = content
        self._passes = passes
        self._stale = False
        return self._content

    def _read_content(self, depsgraph, passes):
        found = read_instances(depsgraph, self._space, with_places="Vector" in passes)
        materials = self._materials
        materials.begin()
        numbers = {look: i for i, look in enumerate(dict.fromkeys(found.looks))}
        slots_of = {k: self._used_slots(depsgraph, s) for k, s in found.sources.items()}
        drawn = {}
        needed = {key: set() for key in found.sources}
        for look in numbers:
            uids = _slot_uids(found.slots[look.slots], slots_of[look.mesh], materials)
            drawn[look] = uids
            if "Normal" in passes:
                needed[look.mesh].add("normal")
            if not look.holdout:
                for slot in slots_of[look.mesh]:
                    graph = materials.materials[uids[slot]].graph
                    needed[look.mesh] |= attributes_read(graph)
        readings = self._read_meshes(depsgraph, found, needed, "Vector" in passes)
        row_look = np.array([numbers[look] for look in found.looks], np.int32)
        order = np.argsort(row_look, kind="stable")
        counts = np.bincount(row_look, minlength=len(numbers))
        groups, first = [], 0
        for look, count in zip(numbers, counts.tolist(), strict=True):
            mesh = readings[look.mesh].snapshot
            if mesh.slots:
                groups.append(InstanceGroup(mesh.uid, drawn[look], first, count, look.holdout))
            first += count
        names = [found.names[i] for i in order.tolist()]
        crypto = any(name.startswith("Crypto") for name in passes)
        instances = InstanceTable(
            world=np.take(found.world, order, axis=0),
            cryptomatte_id=np.array([cryptomatte_id(name) for name in names], np.float32),
            names=tuple(names) if crypto else (),
        )
        if self._content is not None and same_instances(self._content.instances, instances):
            instances = self._content.instances
        used = {group.mesh for group in groups}
        if found.places:
            self._sources = RowSources(
                places=[found.places[i] for i in order.tolist()],
                meshes=[readings[found.looks[i].mesh].snapshot.uid for i in order.tolist()],
                readings={reading.snapshot.uid: reading for reading in readings.values()},
                keys={reading.snapshot.uid: key for key, reading in readings.items()},
            )
        world = _read_world(depsgraph.scene)
        notes = [note for reading in readings.values() for note in reading.notes]
        return SceneContent(
            meshes={
                r.snapshot.uid: r.snapshot for r in readings.values() if r.snapshot.uid in used
            },
            images=materials.images,
            materials=materials.materials,
            instances=instances,
            groups=tuple(groups),
            world=world,
            report=tuple(dict.fromkeys([*found.report, *notes, *materials.report])),
        )

    def _used_slots(self, depsgraph, source):
        known = self._known.get(source.key)
        if known is not None:
            return tuple(slot for slot, _, _ in known.reading.snapshot.slots)
        with source.opened(depsgraph) as mesh:
            return used_slots(mesh)

    def _read_meshes(self, depsgraph, found, needed, for_motion):
        current = {}
        earlier = [*self._doubtful]
        earlier += [k.reading for key, k in self._known.items() if key not in found.sources]
        for key, source in found.sources.items():
            known = self._known.get(key)
            keys = frozenset(needed[key])
            if (
                known is None
                or not keys <= known.keys
                or (for_motion and known.reading.split is None)
            ):
                with source.opened(depsgraph) as mesh:
                    reading = read_mesh(mesh, keys, source.owner)
                equal = _take_equal(earlier, reading.snapshot)
                split = reading.split if for_motion else None
                reading = replace(reading, snapshot=equal, split=split)
                known = _KnownMesh(reading, keys, frozenset(found.owners[key]))
            current[key] = known
        self._known = {key: known for key, known in current.items() if isinstance(key, int)}
        self._doubtful = [k.reading for key, k in current.items() if key not in self._known]
        return {key: known.reading for key, known in current.items()}


def _take_equal(earlier, mesh):
    """Return an equal mesh read before, which no other one may then take, or the new one."""
    for i, candidate in enumerate(earlier):
        if same_content(candidate.snapshot, mesh):
            return earlier.pop(i).snapshot
    return mesh


def _slot_uids(slots, used, materials):
    """Return a material for every slot up to the last that is used, reading only used ones."""
    # As in Blender, a face whose slot does not exist has the last one.
    uids = {slot: materials.read(slots[min(slot, len(slots) - 1)]) for slot in used}
    top = max(used, default=-1)
    return tuple(uids.get(slot, uids[top]) for slot in range(top + 1))


def _is_camera(block):
    kind = type(block).__name__
    return kind == "Camera" or (kind == "Object" and block.type == "CAMERA")


def _read_world(scene):
    color = (0.0, 0.0, 0.0)
    if scene.world and scene.world.node_tree:
        for node in scene.world.node_tree.nodes:
            if node.type == "BACKGROUND":
                strength = node.inputs["Strength"].default_value
                color = tuple(c * strength for c in node.inputs["Color"].default_value[:3])
    return World(color)
