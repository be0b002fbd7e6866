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
        pairs, of_triangle = _edges(triangles)
        wanted = np.zeros(len(pairs), bool)
        wanted[of_triangle[_seen(eye[triangles], *bounds)]] = True
        wanted &= _lengths(eye[pairs], nearest) > longest
        if not wanted.any() or len(triangles) > most:
            break
        number = np.full(len(pairs), -1)
        number[wanted] = len(eye) + np.arange(np.count_nonzero(wanted))
        ends = pairs[wanted]
        arrays = {
            key: np.concatenate([values, 0.5 * (values[ends[:, 0]] + values[ends[:, 1]])])
            for key, values in arrays.items()
        }
        triangles, slots = _split(triangles, slots, number[of_triangle])
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


def _edges(triangles):
    """Return the edges, shape (E, 2), and the three of each triangle: 01, 12, 20."""
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    pairs, inverse = np.unique(sides, axis=0, return_inverse=True)
    return pairs, inverse.reshape(-1, 3)


def _seen(eye, low, high):
    """Return which triangles may meet the picture; `eye`: shape (T, 3, 3)."""
    x, y, z = np.moveaxis(eye, -1, 0)
    sides = (z, x + high[0] * z, -x - low[0] * z, y + high[1] * z, -y - low[1] * z)
    outside = np.zeros(len(eye), bool)
    for side in sides:
        outside |= (side > 0.0).all(axis=1)
    return ~outside


def _lengths(ends, nearest):
    """Return how long edges are in the picture; `ends`: shape (E, 2, 3)."""
    field = ends[..., :2] / np.maximum(-ends[..., 2:], nearest)
    return np.linalg.norm(field[:, 0] - field[:, 1], axis=-1)


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
