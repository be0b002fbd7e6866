"""Reads evaluated Blender meshes into `MeshSnapshot`."""

from dataclasses import dataclass

import numpy as np

from ...snapshot.content import MeshSnapshot, next_uid
from .mesh_attributes import (
    find_attribute,
    polygon_sizes,
    read_attribute,
    read_normals,
    read_tangents,
    without_infinite,
)
from .mesh_islands import islands, pointiness, random_numbers
from .vertex_split import VertexSplit, split_all, split_vertices


@dataclass(frozen=True, eq=False)
class MeshReading:
    """A mesh as it was read.

    Parameters
    ----------
    snapshot : MeshSnapshot
    split : VertexSplit or None
        How corners were split into vertices; `read_moved_positions` needs it.
    notes : tuple of str
        Lines for the report.
    corners : ndarray of shape (3 T,) or None
        Where every triangle has vertices of its own: the mesh's corners that were split.
    """

    snapshot: MeshSnapshot
    split: VertexSplit | None
    notes: tuple[str, ...] = ()
    corners: np.ndarray | None = None


def read_mesh(mesh, keys, owner, base=None, carried=True):
    """Copy an evaluated mesh with the attributes that its surfaces read.

    Parameters
    ----------
    mesh : bpy.types.Mesh
    keys : iterable of str
        As in `MeshSnapshot.attributes`. Those that the mesh lacks are left out.
    owner : str
        Name of an object that shows the mesh, for messages.
    base : bpy.types.Mesh or None
        The mesh that modifiers and shape keys made this one from, if that is known.
    carried : bool
        Whether Blender has carried undeformed coordinates through the modifiers.

    Returns
    -------
    MeshReading

    Notes
    -----
    Triangles with a corner that is not finite are left out, as in Cycles.
    """
    positions = _read_positions(mesh)
    corner_vertices = _read_corner_vertices(mesh)
    slots, triangle_corners = _sorted_by_slot(mesh, _triangle_corners(mesh))
    vertex_values, corner_values, notes = {}, {}, []
    lost = ~np.isfinite(positions).all(axis=1)
    if lost.any():
        positions[lost] = 0.0
        whole = ~lost[np.take(corner_vertices, triangle_corners)].any(axis=1)
        slots, triangle_corners = _chosen_triangles(slots, triangle_corners, whole)
        notes.append(
            f"object '{owner}': {lost.sum()} vertices of mesh '{mesh.name}' have coordinates that"
            f" are not finite; the {(~whole).sum()} triangles there are left out, as in Cycles"
        )
    flat = False
    for key in sorted(keys):
        kind, _, name = key.partition(":")
        if kind == "normal":
            flat = mesh.normals_domain == "FACE"
            values, domain = read_normals(mesh)
        elif kind == "generated":
            known = None if carried else base
            values, domain = _read_generated(mesh, known, positions, corner_vertices), "POINT"
        elif kind in {"pointiness", "island"}:
            values, domain = _read_shape(mesh, kind, positions), "POINT"
        elif kind in {"lowest", "highest"}:
            corner = positions.min(axis=0) if kind == "lowest" else positions.max(axis=0)
            values, domain = np.repeat(corner[None], len(positions), axis=0), "POINT"
        elif kind == "barycentric":
            continue
        elif kind == "tangent":
            values, domain = read_tangents(mesh, name), "CORNER"
            if values is None:
                continue
        else:
            attribute = find_attribute(mesh, kind, name)
            if attribute is None:
                continue
            values, domain = read_attribute(mesh, attribute, kind)
        if not np.isfinite(values).all():
            notes.append(
                f"object '{owner}': attribute '{key}' of mesh '{mesh.name}' has values that are"
                " not finite; drawn as 0 in the faces that have them"
            )
            if kind == "normal":
                values[~np.isfinite(values)] = 0.0
            else:
                values, domain = without_infinite(mesh, values, domain, corner_vertices), "CORNER"
        (vertex_values if domain == "POINT" else corner_values)[key] = values
    own_corners = None
    if "barycentric" in keys:
        # Each triangle has vertices of its own.
        own_corners = triangle_corners.reshape(-1)
        corner_vertices = np.take(corner_vertices, own_corners)
        corner_values = {k: np.take(v, own_corners, axis=0) for k, v in corner_values.items()}
        corner_values["barycentric"] = np.tile(_OF_CORNERS, (len(triangle_corners), 1))
        triangle_corners = np.arange(len(own_corners), dtype=np.int32).reshape(-1, 3)
        split = split_all(corner_vertices)
    elif flat:
        split = split_all(corner_vertices)
    else:
        split = split_vertices(corner_vertices, len(positions), list(corner_values.values()))
    attributes = {key: split.of_vertices(values) for key, values in vertex_values.items()}
    attributes |= {key: split.of_corners(values) for key, values in corner_values.items()}
    rest, _ = _read_rest(mesh, base, positions, _read_corner_vertices(mesh))
    if not np.isfinite(rest).all() or np.array_equal(rest, positions):
        rest = None
    snapshot = MeshSnapshot(
        uid=next_uid(),
        name=mesh.name,
        positions=split.of_vertices(positions),
        triangles=np.take(split.index, triangle_corners),
        slots=slots,
        attributes=attributes,
        rest=None if rest is None else split.of_vertices(rest),
    )
    return MeshReading(snapshot, split, tuple(notes), own_corners)


# Barycentric coordinates of a triangle's corners; the third is what is left of 1.
_OF_CORNERS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], np.float32)


def _read_shape(mesh, kind, positions):
    """Return how pointed vertices are, or the random numbers of their islands, shape (V, 2)."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    if len(edges):
        mesh.attributes[".edge_verts"].data.foreach_get("value", edges)
    edges = edges.reshape(-1, 2)
    if kind == "island":
        values = random_numbers(islands(len(positions), edges))
    else:
        normals = np.empty((len(positions), 3), np.float32)
        if len(normals):
            mesh.vertex_normals.foreach_get("vector", normals.reshape(-1))
        values = pointiness(positions, normals, edges)
    return np.stack([values, np.zeros_like(values)], axis=1)


def used_slots(mesh):
    """Return the material slots that faces of a mesh use, in ascending order.

    Parameters
    ----------
    mesh : bpy.types.Mesh

    Returns
    -------
    tuple of int
    """
    indices = _material_indices(mesh)
    if indices is None:
        return (0,) if len(mesh.polygons) else ()
    return tuple(np.flatnonzero(np.bincount(indices)).tolist())


def read_moved_positions(mesh, reading):
    """Read where the vertices of a mesh are in another frame.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh in the other frame.
    reading : MeshReading
        The mesh as it was read in the frame that is rendered.

    Returns
    -------
    ndarray of shape (V, 3) or None
        None if the mesh has another topology there, or coordinates that are not finite.
    """
    split = reading.split
    corner_vertices = _read_corner_vertices(mesh)
    if reading.corners is not None:
        if len(reading.corners) and reading.corners.max() >= len(corner_vertices):
            return None
        corner_vertices = np.take(corner_vertices, reading.corners)
    if len(corner_vertices) != len(split.index):
        return None
    if len(corner_vertices) and not np.array_equal(
        np.take(split.vertices, split.index), corner_vertices
    ):
        return None
    positions = _read_positions(mesh)
    if not np.isfinite(positions).all():
        return None
    if split.unsplit:
        return positions if len(positions) == len(split.vertices) else None
    if len(split.vertices) and split.vertices.max() >= len(positions):
        return None
    return split.of_vertices(positions)


class EarlierMeshes:
    """Meshes read before, to be found again among those read now: in linear time.

    Parameters
    ----------
    meshes : iterable of MeshSnapshot
    """

    # Vertices by which meshes are told apart before all of them are compared.
    _FIRST = 16

    def __init__(self, meshes):
        self._like = {}
        for mesh in meshes:
            self._like.setdefault(self._key(mesh), []).append(mesh)

    def take_equal(self, mesh):
        """Return an equal mesh read before, each only once, or the mesh itself."""
        alike = self._like.get(self._key(mesh), [])
        for place, candidate in enumerate(alike):
            if same_content(candidate, mesh):
                return alike.pop(place)
        return mesh

    def _key(self, mesh):
        return mesh.name, mesh.slots, len(mesh.positions), mesh.positions[: self._FIRST].tobytes()


def same_content(a, b):
    """Whether two `MeshSnapshot` would draw the same, bit by bit."""
    if (
        a.slots != b.slots
        or a.name != b.name
        or a.attributes.keys() != b.attributes.keys()
        or (a.motion is None) != (b.motion is None)
        or (a.rest is None) != (b.rest is None)
    ):
        return False
    pairs = [(a.positions, b.positions), (a.triangles, b.triangles)]
    pairs += [(values, b.attributes[key]) for key, values in a.attributes.items()]
    if a.motion is not None:
        pairs += zip(a.motion, b.motion, strict=True)
    if a.rest is not None:
        pairs.append((a.rest, b.rest))
    return all(np.array_equal(x, y) for x, y in pairs)


def _read_positions(mesh):
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    if len(positions):
        mesh.attributes["position"].data.foreach_get("vector", positions.reshape(-1))
    return positions


def _read_rest(mesh, base, positions, corner_vertices):
    """Return the rest positions of a mesh, before any deformation, and the mesh they belong to.

    They are those of the mesh that it was made from, if that has the same faces. Otherwise
    Blender may have carried undeformed coordinates through the modifiers for generated texture
    coordinates, as it does for renders; where not, it returns the deformed positions.
    """
    rest = np.empty_like(positions)
    if base is not None and _has_faces(base, len(positions), corner_vertices):
        if len(rest):
            base.attributes["position"].data.foreach_get("vector", rest.reshape(-1))
        return rest, base
    if len(rest):
        mesh.vertices.foreach_get("undeformed_co", rest.reshape(-1))
    return rest, mesh


def _read_generated(mesh, base, positions, corner_vertices):
    """Return generated texture coordinates, shape (V, 3): the texture space spans 0 to 1.

    The texture space is the bounding box of the undeformed mesh unless the artist has set
    another one.
    """
    rest, owner = _read_rest(mesh, base, positions, corner_vertices)
    middle, half = (
        np.array(vector, np.float64) for vector in (owner.texspace_location, owner.texspace_size)
    )
    # In a direction without extent, as in Cycles, everything is in the middle.
    scale = np.divide(0.5, half, out=np.zeros(3), where=half != 0.0)
    return ((rest - middle) * scale + 0.5).astype(np.float32)


def _has_faces(mesh, vertex_count, corner_vertices):
    return (
        len(mesh.vertices) == vertex_count
        and len(mesh.loops) == len(corner_vertices)
        and np.array_equal(_read_corner_vertices(mesh), corner_vertices)
    )


def _chosen_triangles(slots, triangles, chosen):
    """Return the material slots and triangles that are left by a selection of triangles."""
    kept, first = [], 0
    for slot, start, count in slots:
        left = int(chosen[start : start + count].sum())
        if left:
            kept.append((slot, first, left))
        first += left
    return tuple(kept), triangles[chosen]


def _read_corner_vertices(mesh):
    corner_vertices = np.empty(len(mesh.loops), np.int32)
    if len(corner_vertices):
        mesh.attributes[".corner_vert"].data.foreach_get("value", corner_vertices)
    return corner_vertices


def _all_triangles(mesh):
    return len(mesh.loops) == 3 * len(mesh.polygons) and bool((polygon_sizes(mesh) == 3).all())


def _triangle_corners(mesh):
    if _all_triangles(mesh):
        return np.arange(len(mesh.loops), dtype=np.int32).reshape(-1, 3)
    mesh.calc_loop_triangles()
    corners = np.empty((len(mesh.loop_triangles), 3), np.int32)
    if len(corners):
        mesh.loop_triangles.foreach_get("loops", corners.reshape(-1))
    return corners


def _material_indices(mesh):
    """Return the material slot of each polygon, as Blender stores it: 16 bits, never negative."""
    attribute = mesh.attributes.get("material_index")
    if attribute is None or attribute.domain != "FACE" or attribute.data_type != "INT":
        return None
    indices = np.empty(len(mesh.polygons), np.int32)
    if len(indices):
        attribute.data.foreach_get("value", indices)
    return np.clip(indices, 0, 0x7FFF).astype(np.uint16)


def _sorted_by_slot(mesh, corners):
    if len(corners) == 0:
        return (), corners
    per_polygon = _material_indices(mesh)
    if per_polygon is None:
        return ((0, 0, len(corners)),), corners
    if len(corners) == len(per_polygon):
        material = per_polygon
    else:
        polygon = np.empty(len(corners), np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", polygon)
        material = np.take(per_polygon, polygon)
    counts = np.bincount(material)
    used = np.flatnonzero(counts)
    ends = np.cumsum(counts)
    slots = tuple((int(s), int(ends[s] - counts[s]), int(counts[s])) for s in used)
    if len(used) == 1:
        return slots, corners
    # A stable sort of 16-bit integers is a radix sort.
    order = np.argsort(material, kind="stable")
    return slots, np.take(corners, order, axis=0)
