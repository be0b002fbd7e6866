"""From Blender's evaluated scene to a `SceneSnapshot`."""

import numpy as np

from .camera import read_camera
from .materials import MaterialReader
from .meshes import read_mesh
from .settings import read_film, read_passes, read_sampling
from .snapshot import InstanceGroup, InstanceTable, SceneContent, SceneSnapshot, World


class SceneExtractor:
    """Extracts snapshots, keeping the parts that did not change between two of them."""

    def __init__(self):
        self._meshes = {}

    def extract(self, depsgraph):
        """Return the snapshot of an evaluated scene for its view layer.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph

        Returns
        -------
        SceneSnapshot
        """
        scene = depsgraph.scene
        film = read_film(scene)
        return SceneSnapshot(
            content=self.extract_content(depsgraph),
            camera=read_camera(depsgraph, scene.camera, film),
            film=film,
            sampling=read_sampling(scene),
            passes=read_passes(depsgraph.view_layer),
            layer_name=depsgraph.view_layer.name,
            alpha_threshold=depsgraph.view_layer.pass_alpha_threshold,
        )

    def extract_content(self, depsgraph):
        """Return what stands in front of the camera."""
        scene = depsgraph.scene
        materials = MaterialReader()
        meshes, rows, groups = {}, [], {}
        for instance in depsgraph.object_instances:
            obj = instance.object
            if obj.type != "MESH":
                continue
            data = obj.data
            mesh = self._mesh(data)
            meshes[mesh.uid] = mesh
            slots = [s.material for s in obj.material_slots] or [None]
            top = max((slot for slot, _, _ in mesh.slots), default=0)
            uids = tuple(materials.read(slots[min(i, len(slots) - 1)]) for i in range(top + 1))
            matrix = np.array(instance.matrix_world, np.float32)
            groups.setdefault((mesh.uid, uids, obj.is_holdout), []).append(matrix)
        table, out = [], []
        for (mesh_uid, uids, holdout), matrices in groups.items():
            out.append(InstanceGroup(mesh_uid, uids, len(table), len(matrices), holdout))
            table.extend(matrices)
        world = np.array(table, np.float32).reshape(-1, 4, 4)
        color = (0.0, 0.0, 0.0)
        if scene.world and scene.world.node_tree:
            for node in scene.world.node_tree.nodes:
                if node.type == "BACKGROUND":
                    strength = node.inputs["Strength"].default_value
                    color = tuple(c * strength for c in node.inputs["Color"].default_value[:3])
        return SceneContent(
            meshes=meshes,
            images=materials.images,
            materials=materials.materials,
            instances=InstanceTable(world, np.zeros(len(world), np.float32)),
            groups=tuple(out),
            world=World(color),
        )

    def _mesh(self, data):
        key = data.as_pointer()
        mesh = self._meshes.get(key)
        if mesh is None:
            mesh = self._meshes[key] = read_mesh(data)
        return mesh
