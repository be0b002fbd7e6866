"""Motion vectors: transforms and positions in the neighbouring frames, for the Vector pass.

As in Cycles, motion is measured from the previous frame and to the next. A mesh whose topology
changes between them, or an instance that is missing in the other frame, does not move.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...snapshot.content import next_uid
from ..camera.camera import read_pose
from .instances import place
from .meshes import read_moved_positions


@dataclass(frozen=True, eq=False)
class RowSources:
    """Sources of the rows of an instance table: instances, meshes and their readings.

    Parameters
    ----------
    places : list of tuple
        Identity of a row's instance across frames.
    meshes : list of int
        `MeshSnapshot.uid`.
    readings : dict of int to MeshReading
        By that uid.
    keys : dict of int to object
        `MeshSource.key` by that uid.
    """

    places: list
    meshes: list
    readings: dict
    keys: dict


def add_motion(snapshot, sources, depsgraph, frame_set, view=None):
    """Return a snapshot with motion of camera, instances and deforming meshes.

    Parameters
    ----------
    snapshot : SceneSnapshot
        Of the current frame.
    sources : RowSources
    depsgraph : bpy.types.Depsgraph
        Evaluated three times; data read from it before is invalid afterwards.
    frame_set : callable
        ``frame_set(frame, subframe)``, such as a render engine's.
    view : engine.views.View or None
        As `read_pose` takes it.

    Returns
    -------
    SceneSnapshot

    Notes
    -----
    Objects with coordinates or transforms that are not finite in a neighbouring frame do not move.
    """
    scene = depsgraph.scene
    camera, frame, subframe = scene.camera, scene.frame_current, scene.frame_subframe
    poses, notes = [], []
    try:
        for step in (-1, 1):
            frame_set(frame + step, subframe)
            world, moved, lost = _read_pose(depsgraph, snapshot.content.instances.world, sources)
            notes += [
                f"object '{name}': its transform in frame {frame + step} has numbers that are not"
                " finite; it stands still in the Vector pass"
                for name in lost
            ]
            pose = read_pose(depsgraph, camera, snapshot.film, view, snapshot.camera.real_lens)
            poses.append((world, moved, pose))
    finally:
        frame_set(frame, subframe)
    (world_before, moved_before, camera_before), (world_after, moved_after, camera_after) = poses
    content = _with_moved_meshes(snapshot.content, moved_before, moved_after)
    table = replace(content.instances, previous_world=world_before, next_world=world_after)
    return replace(
        snapshot,
        content=replace(content, instances=table, report=(*content.report, *notes)),
        camera=replace(snapshot.camera, previous=camera_before, next=camera_after),
    )


def _read_pose(depsgraph, here, sources):
    """Return transforms and moved meshes, and the names of objects without a finite transform."""
    rows = {name: row for row, name in enumerate(sources.places)}
    world = here.copy()
    moved, lost = {}, {}
    for instance in depsgraph.object_instances:
        if instance.object.type != "MESH":
            continue
        row = rows.get(place(instance))
        if row is None:
            continue
        world[row] = instance.matrix_world
        if not np.isfinite(world[row]).all():
            world[row] = here[row]
            lost[instance.object.name_full] = True
        uid = sources.meshes[row]
        if uid in moved:
            continue
        mesh = instance.object.data
        moved[uid] = None
        if mesh.session_uid != sources.keys[uid]:
            moved[uid] = read_moved_positions(mesh, sources.readings[uid])
    return world, moved, tuple(lost)


def _with_moved_meshes(content, moved_before, moved_after):
    meshes, new_uids = {}, {}
    for uid, mesh in content.meshes.items():
        motion = tuple(
            mesh.positions if moved.get(uid) is None else moved[uid]
            for moved in (moved_before, moved_after)
        )
        if any(not np.array_equal(positions, mesh.positions) for positions in motion):
            mesh = replace(mesh, uid=next_uid(), motion=motion)
        new_uids[uid] = mesh.uid
        meshes[mesh.uid] = mesh
    groups = tuple(replace(group, mesh=new_uids[group.mesh]) for group in content.groups)
    return replace(content, meshes=meshes, groups=groups)
