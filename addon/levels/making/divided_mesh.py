"""Dividing large triangles, so that what is computed at their corners is good in between, too.

Edges that are long as the camera sees them are halved, round by round. Both triangles of an edge
are divided by the same rule, so that no gaps open.
"""

from dataclasses import replace

import numpy as np

_MOST_ROUNDS = 12


def divided_mesh(mesh, to_eye, longest, bounds, nearest, most=60_000):
    """Divide the triangles of a mesh that a camera sees large.

    Parameters
    ----------
    mesh : MeshSnapshot
    to_eye : ndarray of shape (4, 4)
        Object to camera space.
    longest : float
        Edges are divided until they are no longer, as tangents seen from the camera.
    bounds : tuple of two ndarray of shape (2,)
        Corners of the picture, as tangents; triangles outside of it are left as they are.
    nearest : float
        Depth as which nearer places count, m.
    most : int
        Triangles; with more no further round is begun.

    Returns
    -------
    MeshSnapshot
        The mesh itself if nothing is to be divided.
    """
    corners, triangles = mesh.positions.astype(np.float64), mesh.triangles.astype(np.int64)
    slots = np.repeat([slot for slot, _, _ in mesh.slots], [count for _, _, count in mesh.slots])
    # Weights of the mesh' own corners would be exact; halves of halves are, too.
    arrays = {f"attribute:{key}": values for key, values in mesh.attributes.items()}
    if mesh.motion is not None:
        arrays |= {"motion:0": mesh.motion[0], "motion:1": mesh.motion[1]}
    arrays = {key: values.astype(np.float64) for key, values in arrays.items()}
    arrays["positions"] = corners
    whole = len(triangles)
    for _ in range(_MOST_ROUNDS):
        eye = arrays["positions"] @ to_eye[:3, :3].T + to_eye[:3, 3]
        sides = _sides(triangles, len(eye))
        seen = np.flatnonzero(_seen(eye[triangles], *bounds))
        wanted = np.unique(sides[seen][_lengths(eye[triangles[seen]], nearest) > longest])
        if not len(wanted) or len(triangles) > most:
            break
        ends = np.divmod(wanted, len(eye))
        number = np.minimum(np.searchsorted(wanted, sides), len(wanted) - 1)
        middles = np.where(wanted[number] == sides, len(eye) + number, -1)
        arrays = {
            key: np.concatenate([values, 0.5 * (values[ends[0]] + values[ends[1]])])
            for key, values in arrays.items()
        }
        triangles, slots = _split(triangles, slots, middles)
    if len(triangles) == whole:
        return mesh
    order = np.argsort(slots, kind="stable")
    found, counts = np.unique(slots[order], return_counts=True)
    firsts = np.cumsum(counts) - counts
    values = {key: part.astype(np.float32) for key, part in arrays.items()}
    motion = mesh.motion and (values["motion:0"], values["motion:1"])
    return replace(
        mesh,
        positions=values["positions"],
        triangles=triangles[order].astype(np.int32),
        slots=tuple(zip(found.tolist(), firsts.tolist(), counts.tolist(), strict=True)),
        attributes={key: values[f"attribute:{key}"] for key in mesh.attributes},
        motion=motion,
        rest=None,
    )


def _sides(triangles, count):
    """Return the edges 01, 12, 20 as numbers that both of their triangles have for them."""
    ends = triangles, triangles[:, [1, 2, 0]]
    return np.minimum(*ends) * count + np.maximum(*ends)


def _seen(eye, low, high):
    """Return which triangles may meet the picture; `eye`: shape (T, 3, 3)."""
    x, y, z = np.moveaxis(eye, -1, 0)
    sides = (z, x + high[0] * z, -x - low[0] * z, y + high[1] * z, -y - low[1] * z)
    outside = np.zeros(len(eye), bool)
    for side in sides:
        a, b, c = (side > 0.0).T
        outside |= a & b & c
    return ~outside


def _lengths(eye, nearest):
    """Return how long edges are in the picture, shape (T, 3); `eye`: corners, (T, 3, 3)."""
    field = eye[..., :2] / np.maximum(-eye[..., 2:], nearest)
    return np.linalg.norm(field - field[:, [1, 2, 0]], axis=-1)


def _split(triangles, slots, middles):
    """Divide triangles by the middles of their edges 01, 12, 20 (-1: none)."""
    made, of_slot = [], []

    def add(rows, *corners):
        if len(rows):
            made.append(np.stack(corners, axis=1))
            of_slot.append(slots[rows])

    count = (middles >= 0).sum(axis=1)
    rows = np.flatnonzero(count == 0)
    add(rows, *triangles[rows].T)
    for turn in range(3):
        order = [turn, (turn + 1) % 3, (turn + 2) % 3]
        # One edge, the first of the turned triangle; or all but the last.
        for wanted in (1, 2):
            on = middles[:, order] >= 0
            rows = np.flatnonzero((count == wanted) & on[:, :wanted].all(axis=1))
            a, b, c = triangles[rows][:, order].T
            p, q, _ = middles[rows][:, order].T
            if wanted == 1:
                add(rows, a, p, c)
                add(rows, p, b, c)
            else:
                add(rows, p, b, q)
                add(rows, a, p, q)
                add(rows, a, q, c)
    rows = np.flatnonzero(count == 3)
    (a, b, c), (p, q, r) = triangles[rows].T, middles[rows].T
    for corners in ((a, p, r), (p, b, q), (r, q, c), (p, q, r)):
        add(rows, *corners)
    return np.concatenate(made), np.concatenate(of_slot)
