"""Light samples: which light each lens sample sees the scene from, and from where on it (**ours**).

Each lens sample also sees the scene from one place on one light. Lights have their turns in
proportion to their share of the light, exactly so within a period, and spread over it: after any
number of samples each light has had about its share. Places on a light are a low-discrepancy
sequence of its own.
"""

import numpy as np

# From so many turns in a period on a light's turns are stratified at random, so that they follow
# none of the sequences of the lens; fewer come at the end of their share of the period, so that no
# light is overdrawn before it.
_MANY_TURNS = 8
_BALL_TABLE = 1024
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def turns_of(shares, count):
    """Return how many of `count` light samples each light gets.

    Parameters
    ----------
    shares : array_like of shape (L,)
        Not negative; of any sum.
    count : int

    Returns
    -------
    ndarray of shape (L,)
        int, of the sum `count`, or 0 where no share is positive. Every light with a share gets one
        at least; if there are more lights than samples, those with the largest shares do.
    """
    shares = np.maximum(np.asarray(shares, np.float64), 0.0)
    turns = np.zeros(len(shares), np.int64)
    order = np.argsort(-shares, kind="stable")
    order = order[shares[order] > 0.0][:count]
    if not len(order):
        return turns
    turns[order] = 1
    left = count - len(order)
    wanted = shares[order] / shares[order].sum() * count - 1.0
    wanted = np.maximum(wanted, 0.0)
    if left and wanted.sum() > 0.0:
        wanted *= left / wanted.sum()
    whole = np.floor(wanted).astype(np.int64)
    turns[order] += whole
    rest = np.argsort(-(wanted - whole), kind="stable")[: left - whole.sum()]
    turns[order[rest]] += 1
    return turns


def schedule(turns, seed=0):
    """Return whose turn it is at each light sample of a period.

    Parameters
    ----------
    turns : ndarray of shape (L,)
        As of `turns_of`.
    seed : int

    Returns
    -------
    lights : ndarray of shape (turns.sum(),)
        int.
    numbers : ndarray of the same shape
        int; which turn of its light it is.
    """
    turns = np.asarray(turns, np.int64)
    count = int(turns.sum())
    lights = np.repeat(np.arange(len(turns)), turns)
    ends = np.cumsum(turns)
    numbers = np.arange(count) - np.repeat(ends - turns, turns)
    rng = np.random.default_rng([seed, 3])
    early = np.where(turns >= _MANY_TURNS, 1.0, 0.0)[lights] * rng.random(count)
    due = (numbers + 1.0 - early) / np.maximum(turns, 1)[lights]
    order = np.lexsort((rng.random(count), due))
    return lights[order], numbers[order]


def sequence(numbers, dimensions, seed=0, stream=0):
    """Return points of an additive recurrence that fills a cube evenly, shifted at random.

    Parameters
    ----------
    numbers : array_like of int, shape (N,)
        Which points.
    dimensions : int
    seed, stream : int
        Of the shift.

    Returns
    -------
    ndarray of shape (N, dimensions)
        float64 in [0, 1).

    References
    ----------
    Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018.
    """
    ratio = 1.5
    for _ in range(48):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1.0))
    steps = ratio ** -np.arange(1.0, dimensions + 1.0)
    shift = np.random.default_rng([seed, 4, stream]).random(dimensions)
    return np.mod(shift + np.asarray(numbers)[:, None] * steps, 1.0)


def sky_places(pairs, sets, seed=0, stream=0, lattice=0):
    """Return where in the square directions of the sky are.

    They are pairs of opposite directions, so that one of each is above every surface, half of them
    a Fibonacci lattice, turned at random, so that all together are even. Lens samples get their
    first pairs in an order that begins all over the lattice, further ones by chance, so that what
    is hidden of one pair says nothing of how much light another gives.

    Parameters
    ----------
    pairs : int
        Of a lens sample.
    sets : int
        Lens samples.
    seed, stream, lattice : int
        Of the turn and the chance.

    Returns
    -------
    ndarray of shape (sets, pairs, 2, 2)
        Longitude and sine of the latitude, from 0 to 1.
    """
    number = np.arange(pairs * sets)
    along = np.mod(number * _GOLDEN, 1.0)
    rng = np.random.default_rng([seed, 6, stream, lattice])
    turn = rotation(rng.random(3))
    half = sphere_points(np.column_stack([(number + 0.5) / (2 * pairs * sets), along])) @ turn.T
    half = half[np.argsort(along)].reshape(sets, pairs, 3)
    for pair in range(1, pairs):
        half[:, pair] = rng.permutation(half[:, pair])
    x, y, z = np.moveaxis(np.stack([half, -half], axis=2), -1, 0)
    found = np.stack([np.arctan2(y, x) / (2.0 * np.pi) + 0.5, 0.5 * z + 0.5], axis=-1)
    return np.clip(found, 0.0, 1.0 - 1e-9)


def rotation(u):
    """Return an even random rotation from three numbers from 0 to 1 (Shoemake, 1992)."""
    a, b = np.sqrt(1.0 - u[0]), np.sqrt(u[0])
    x, y = a * np.sin(2 * np.pi * u[1]), a * np.cos(2 * np.pi * u[1])
    z, w = b * np.sin(2 * np.pi * u[2]), b * np.cos(2 * np.pi * u[2])
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def disk_points(u):
    """Map points of the square to the unit disk, preserving areas and neighbours.

    Parameters
    ----------
    u : ndarray of shape (N, 2)

    Returns
    -------
    ndarray of shape (N, 2)
    """
    x, y = 2.0 * u.T - 1.0
    wide = np.abs(x) > np.abs(y)
    radius = np.where(wide, x, y)
    safe = np.where(radius == 0.0, 1.0, radius)
    angle = np.where(wide, np.pi / 4 * y / safe, np.pi / 2 - np.pi / 4 * x / safe)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def sphere_points(u):
    """Map points of the square to the unit sphere, preserving areas.

    Parameters
    ----------
    u : ndarray of shape (N, 2)

    Returns
    -------
    ndarray of shape (N, 3)
    """
    z = 1.0 - 2.0 * u[:, 0]
    around = 2.0 * np.pi * u[:, 1]
    across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.column_stack([across * np.cos(around), across * np.sin(around), z])


def ball_points(u):
    """Map points of the cube to the unit ball so that it looks like an even disk from everywhere.

    One place must serve all points that a lamp lights, and each sees the lamp as a disk that faces
    it. Their density is 1 / (pi^2 sqrt(1 - r^2)), the inverse Abel transform of an even disk.

    Parameters
    ----------
    u : ndarray of shape (N, 3)

    Returns
    -------
    ndarray of shape (N, 3)
    """
    # r = sin t has the distribution 2 / pi (t - sin t cos t).
    t = np.linspace(0.0, np.pi / 2, _BALL_TABLE)
    inside = (t - np.sin(t) * np.cos(t)) * 2.0 / np.pi
    radius = np.sin(np.interp(u[:, 2], inside, t))
    return sphere_points(u[:, :2]) * radius[:, None]
