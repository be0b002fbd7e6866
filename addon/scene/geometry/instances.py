"""Blender's evaluated objects to a list of drawn copies of meshes.

Which objects are drawn follows Cycles: an instance must be visible to the camera itself and through
its instancer; holdout and indirect-only collections act on the instancer's place in the view layer.
"""

from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np

from ..shading.lights import MAX_LIGHTS, read_light
from .random_numbers import object_number, share_of_range

# Object types with a surface or substance of their own that the engine cannot draw: in words,
# the view layer's switch for them, and how to tell an empty one.
_UNDRAWN = {
    "CURVES": ("hair curves", "use_strand", lambda data: len(data.curves)),
    "POINTCLOUD": ("a point cloud", "use_solid", lambda data: len(data.points)),
    "VOLUME": ("a volume", "use_volumes", lambda data: True),
}


@dataclass(frozen=True, eq=False)
class MeshSource:
    """A mesh of the evaluated scene, to be read while that scene is not evaluated again.

    Parameters
    ----------
    key : object
        Identifies this evaluated state of the mesh within the process: Blender numbers each
        evaluated mesh afresh, so an edited mesh, another frame or a state after undo has another
        key, even at the same address. A mesh without a number gets a new key each time.
    mesh : bpy.types.Mesh
    wrapped_by : bpy.types.Object or None
        The object whose evaluated mesh is a wrapper that may lack elements: in edit mode, and where
        Blender leaves subdivision to the graphics device.
    owner : str
        Name of the first object that shows it.
    base : bpy.types.Mesh or None
        The mesh that the object's modifiers and shape keys start from, in the same evaluated scene.
    carried : bool
        Whether `mesh` has undeformed coordinates for generated texture coordinates: Blender carries
        them through the modifiers for renders only, and only geometry nodes know what they do to
        them.
    """

    key: object
    mesh: object
    wrapped_by: object
    owner: str
    base: object = None
    carried: bool = True

    @contextmanager
    def opened(self, depsgraph):
        """Yield the mesh with all its elements, valid inside a `with` block."""
        if self.wrapped_by is None:
            yield self.mesh
            return
        evaluated = self.wrapped_by.evaluated_get(depsgraph)
        try:
            yield evaluated.to_mesh()
        finally:
            evaluated.to_mesh_clear()


@dataclass(frozen=True)
class Look:
    """Key of instances that can be drawn together: mesh, materials, visibility.

    Parameters
    ----------
    mesh : object
        `MeshSource.key`.
    slots : int
        Which of `InstanceList.slots`.
    holdout : bool
    camera, shadow : bool
        The camera sees it; it hides the light of lamps and the sky.
    """

    mesh: object
    slots: int
    holdout: bool
    camera: bool = True
    shadow: bool = True


@dataclass(eq=False)
class InstanceList:
    """Everything that is drawn.

    Attributes
    ----------
    sources : dict of object to MeshSource
        By key.
    owners : dict of object to set of int
        For each mesh the session numbers of the data-blocks it was made from.
    slots : list of tuple of bpy.types.Material or None
        Different assignments of materials to slots.
    looks : list of Look
        One an instance.
    names : list of str
        Of the object, one an instance.
    world : ndarray of shape (I, 4, 4)
        float32.
    object_values : ndarray of shape (I, 6)
        As `InstanceTable.looks`.
    places : list of tuple
        Identity of each instance across frames, see `place`; only if asked for.
    lights : list of Light
    report : tuple of str
    """

    sources: dict = field(default_factory=dict)
    owners: dict = field(default_factory=dict)
    slots: list = field(default_factory=list)
    looks: list = field(default_factory=list)
    names: list = field(default_factory=list)
    world: np.ndarray = None
    object_values: np.ndarray = None
    places: list = field(default_factory=list)
    lights: list = field(default_factory=list)
    report: tuple = ()


def read_instances(depsgraph, space=None, shadows=False, with_places=False):
    """List the copies of meshes that the camera may see.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    space : bpy.types.SpaceView3D or None
        The 3D view whose local view and collections apply.
    shadows : bool
        Whether copies are listed that the camera does not see, and that throw shadows.
    with_places : bool
        Fill `InstanceList.places`.

    Returns
    -------
    InstanceList

    Notes
    -----
    Instances whose transform is not finite are left out, as in Cycles.
    """
    reader = _Reader(depsgraph, space, shadows)
    out = reader.out
    matrices, values = [], []
    for instance in depsgraph.object_instances:
        found = reader.read(instance)
        if found is None:
            continue
        look, name, (color, number, pass_index) = found
        out.looks.append(look)
        out.names.append(name)
        # Blender shows these 32 bits as a signed number.
        number = instance.random_id % 2**32 if instance.is_instance else number
        values.append((*color, share_of_range(number), pass_index))
        # Blender fills the same matrix again for the next instance.
        matrices.append(instance.matrix_world.copy())
        if with_places:
            out.places.append(place(instance))
    out.world = np.array(matrices, np.float32).reshape(-1, 4, 4)
    out.object_values = np.array(values, np.float32).reshape(-1, 6)
    finite = np.isfinite(out.world).all(axis=(1, 2))
    if not finite.all():
        for i in np.flatnonzero(~finite):
            reader.note(out.names[i], "its transform has numbers that are not finite; left out")
        chosen = np.flatnonzero(finite).tolist()
        out.world, out.object_values = out.world[finite], out.object_values[finite]
        out.looks, out.names = ([column[i] for i in chosen] for column in (out.looks, out.names))
        if with_places:
            out.places = [out.places[i] for i in chosen]
    out.report = reader.report()
    return out


def place(instance):
    """Return the identity of an instance across frames.

    Parameters
    ----------
    instance : bpy.types.DepsgraphObjectInstance

    Returns
    -------
    tuple
    """
    number = instance.object.original.session_uid
    if not instance.is_instance:
        return (number,)
    return (number, instance.parent.original.session_uid, *instance.persistent_id)


class _Reader:
    def __init__(self, depsgraph, space, shadows):
        self.out = InstanceList()
        self._depsgraph = depsgraph
        self._in_viewport = depsgraph.mode == "VIEWPORT"
        # Evaluated, as the objects are: animated switches are not written back while rendering.
        self._view_layer = depsgraph.view_layer_eval
        self._override = self._view_layer.material_override
        self._shadows = shadows
        self._space = space
        self._kinds = {}
        self._place_flags = {}
        self._slot_numbers = {}
        self._counts = {}

    def read(self, instance):
        """Return `Look`, name and values of the object of an instance that is drawn, else None."""
        obj = instance.object
        data = obj.data
        if data is None:
            return None
        parent = instance.parent if instance.is_instance else obj
        if obj.type == "LIGHT":
            # A light illuminates the scene even where the camera does not see it.
            if instance.show_self and self._is_in_view(obj):
                self._read_light(obj, parent, instance.matrix_world)
            return None
        number = data.session_uid or ("unnumbered", data.as_pointer())
        shown = (instance.show_self, instance.show_particles)
        # Copies of one object under one instancer are alike; there may be very many.
        key = (obj.original.session_uid, parent.original.session_uid, number, shown)
        if key not in self._kinds:
            self._kinds[key] = self._read_kind(obj, parent, number, *shown)
        drawn, notes = self._kinds[key]
        for name, what in notes:
            self.note(name, what)
        return drawn

    def _read_kind(self, obj, parent, number, show_self, show_particles):
        """Return what `read` does, and the warnings of an instance."""
        holdout, indirect_only, parent_visible = self._flags_of_place(parent)
        camera = obj.visible_camera and parent_visible and (holdout or not indirect_only)
        shadow = obj.visible_shadow and parent.visible_shadow
        if not (camera or (shadow and self._shadows)) or not self._is_in_view(obj):
            return None, ()
        name = obj.name
        switches = self._view_layer
        notes = list(_hair_notes(obj)) if show_particles and switches.use_strand else []
        drawn = None
        if show_self and obj.type == "MESH" and switches.use_solid:
            self._add_source(obj, parent, number)
            values = tuple(obj.color), object_number(name), obj.pass_index
            drawn = Look(number, self._slots(obj), holdout, camera, shadow), name, values
            if obj.is_shadow_catcher:
                notes.append("a shadow catcher is drawn as any other surface")
            if _is_diced(obj):
                notes.append("adaptive subdivision is drawn as the levels of its modifier")
        elif show_self and obj.type == "LIGHT_PROBE":
            notes.append("a light probe is not used")
        elif show_self and obj.type in _UNDRAWN:
            what, switch, size = _UNDRAWN[obj.type]
            if getattr(switches, switch) and size(obj.data):
                notes.append(f"{what} cannot be drawn; left out")
        # What only throws shadows is not missed in the picture.
        return drawn, tuple((obj.name_full, note) for note in notes if camera)

    def _is_in_view(self, obj):
        return self._space is None or obj.visible_in_viewport_get(self._space)

    def _read_light(self, obj, parent, matrix):
        if len(self.out.lights) == MAX_LIGHTS:
            self.note(obj.name_full, f"more than {MAX_LIGHTS} lights; this one does not shine")
            return
        light, notes = read_light(obj.data, matrix)
        if light is not None:
            # As in Cycles and EEVEE, an instance has the ray visibility of its instancer, too.
            if not (obj.visible_diffuse and parent.visible_diffuse):
                light = replace(light, diffuse_factor=0.0)
            if not (obj.visible_glossy and parent.visible_glossy):
                light = replace(light, specular_factor=0.0)
            self.out.lights.append(light)
            notes += _light_object_notes(obj, parent)
        for note in notes:
            self.note(obj.name_full, note)

    def _flags_of_place(self, parent):
        number = parent.original.session_uid
        flags = self._place_flags.get(number)
        if flags is None:
            flags = (
                parent.holdout_get(view_layer=self._view_layer),
                parent.indirect_only_get(view_layer=self._view_layer),
                parent.visible_camera,
            )
            self._place_flags[number] = flags
        return flags

    def _add_source(self, obj, parent, number):
        out, original = self.out, obj.original
        if number not in out.sources:
            wrapped = obj.data.is_editmode or self._may_be_subdivided_later(original, obj.data)
            wrapped_by = original if wrapped else None
            base = None
            # In edit mode the mesh is in Blender's hands, not in the data-block.
            if original.type == "MESH" and not obj.data.is_editmode:
                base = original.data.evaluated_get(self._depsgraph)
            carried = not self._in_viewport or any(m.type == "NODES" for m in original.modifiers)
            source = MeshSource(number, obj.data, wrapped_by, obj.name_full, base, carried)
            out.sources[number] = source
            out.owners[number] = set()
        owners = out.owners[number]
        owners |= {original.session_uid, parent.original.session_uid}
        if original.data is not None:
            owners.add(original.data.session_uid)

    def _may_be_subdivided_later(self, original, data):
        if not self._in_viewport or original.type != "MESH":
            return False
        shown = [modifier.type for modifier in original.modifiers if modifier.show_viewport]
        if not shown or shown[-1] != "SUBSURF":
            return False
        # Other meshes may come from the same object: what its geometry nodes instance.
        return original.evaluated_get(self._depsgraph).data == data

    def _slots(self, obj):
        if self._override is not None:
            materials = (self._override,)
        else:
            materials = tuple(slot.material for slot in obj.material_slots) or (None,)
        identity = tuple(m.original.session_uid if m else 0 for m in materials)
        number = self._slot_numbers.setdefault(identity, len(self.out.slots))
        if number == len(self.out.slots):
            self.out.slots.append(materials)
        return number

    def note(self, name, what):
        """Add a warning about a property of an object that is not drawn as it is set."""
        self._counts[name, what] = self._counts.get((name, what), 0) + 1

    def report(self):
        """Return one line for each object and reason, however many copies there are."""
        return tuple(
            f"object '{name}': {what}" + (f" ({count} copies)" if count > 1 else "")
            for (name, what), count in self._counts.items()
        )


def _light_object_notes(obj, parent):
    if obj.visible_camera and parent.visible_camera:
        yield "is to be seen by the camera; what a lamp lights is drawn, the lamp itself is not"
    if obj.light_linking.receiver_collection is not None:
        yield "light linking is not done; everything is lit"
    if obj.light_linking.blocker_collection is not None:
        yield "shadow linking is not done; everything throws shadows"


def _is_diced(obj):
    return any(
        modifier.type == "SUBSURF" and modifier.show_render and modifier.use_adaptive_subdivision
        for modifier in obj.modifiers
    )


def _hair_notes(obj):
    for modifier in obj.modifiers:
        if modifier.type != "PARTICLE_SYSTEM":
            continue
        settings = modifier.particle_system.settings
        if settings.type == "HAIR" and settings.render_type == "PATH":
            yield f"particle hair '{settings.name}' cannot be drawn; left out"
        elif settings.render_type in {"HALO", "LINE"}:
            yield f"particles drawn as {settings.render_type.lower()} cannot be drawn; left out"
