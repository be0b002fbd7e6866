"""What a light sees of a scene from one place on it: projections fitted to what the camera sees.

Suns and the sky see along parallel lines, in slices of the camera's depth that are the wider the
farther they are. Lamps see through one frustum where what the camera sees lies to one side of them,
else through faces of a cube around them.
"""

from dataclasses import dataclass

import numpy as np

from ...sampling.lights.light_samples import rotation

# Tangent of the half angle of a frustum up to which one is enough for a lamp.
_WIDEST = 2.0
# Nearest depth of a lamp's view, in its farthest.
_NEAREST = 1e-3
# Slices of the camera's depth, and the ratio of the depths of a slice up to which one does.
MOST_SLICES = 4
_SLICE_RATIO = 3.0
# Faces of a cube overlap by this share.
_OVERLAP = 0.01
# Frusta around all receivers are so much wider, for rounding.
_WIDER = 1.005
# Columns and rows of a tile that holds so many maps.
_LAYOUTS = {1: (1, 1), 2: (2, 1), 3: (2, 2), 4: (2, 2), 5: (3, 2), 6: (3, 2)}


@dataclass(frozen=True, eq=False)
class LightView:
    """A projection from a place on a light.

    Parameters
    ----------
    origin : ndarray of shape (3,)
        Where depths begin, in world space.
    across, up : ndarray of shape (3,)
        From the middle to the edges: at depth 1, or if parallel at any depth.
    along : ndarray of shape (3,)
        Unit length, away from the light.
    parallel : bool
    near, far : float
        Least and largest depth, m.
    """

    origin: np.ndarray
    across: np.ndarray
    up: np.ndarray
    along: np.ndarray
    parallel: bool
    near: float
    far: float

    def matrices(self):
        """Return the matrices from world to the view's space, and from there to clip space."""
        wide, high = np.linalg.norm(self.across), np.linalg.norm(self.up)
        view = np.eye(4)
        view[:3, :3] = self.across / wide, self.up / high, -self.along
        view[:3, 3] = -view[:3, :3] @ self.origin
        near, far = self.near, self.far
        projection = np.diag([1.0 / wide, 1.0 / high, 0.0, 0.0])
        if self.parallel:
            projection[2, 2:] = -2.0 / (far - near), -(far + near) / (far - near)
            projection[3, 3] = 1.0
        else:
            projection[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
            projection[3, 2] = -1.0
        return view, projection

    def sees(self, centers, radii):
        """Return which spheres may be in the view, or between it and a sun.

        Parameters
        ----------
        centers : ndarray of shape (I, 3)
        radii : ndarray of shape (I,)

        Returns
        -------
        ndarray of shape (I,)
            bool.
        """
        offset = centers - self.origin
        depth = offset @ self.along
        seen = depth - radii <= self.far
        if not self.parallel:
            seen &= depth + radii >= 0.0
        for axis in (self.across, self.up):
            size = np.linalg.norm(axis)
            place = np.abs(offset @ (axis / size))
            if self.parallel:
                seen &= place - radii <= size
            else:
                seen &= place - depth * size <= radii * np.hypot(1.0, size)
        return seen

    def _texel(self, rectangle):
        """Return the size of a texel of its map at depth 1, or if parallel at any."""
        _, _, width, height = rectangle
        return 2.0 * max(np.linalg.norm(self.across) / width, np.linalg.norm(self.up) / height)

    def texel_sizes(self, rectangle, centers, radii):
        """Return the size of a texel of its map where it is smallest in each sphere, m.

        Parameters
        ----------
        rectangle : tuple of 4 int
        centers : ndarray of shape (I, 3)
        radii : ndarray of shape (I,)

        Returns
        -------
        ndarray of shape (I,)
        """
        texel = np.full(len(radii), self._texel(rectangle))
        if self.parallel:
            return texel
        depth = (centers - self.origin) @ self.along - radii
        return texel * np.maximum(depth, self.near)

    def texels(self, rectangle):
        """Return its texels in the light table; ``lib/surface/light_map_lib.glsl``.

        Parameters
        ----------
        rectangle : tuple of 4 int
            x, y, width, height of its map in the atlas, texels.

        Returns
        -------
        ndarray of shape (5, 4)
        """
        texel = self._texel(rectangle)
        return np.array(
            [
                (*self.origin, float(self.parallel)),
                (*self.across, self.near),
                (*self.up, self.far),
                (*self.along, texel),
                rectangle,
            ]
        )


@dataclass(frozen=True, eq=False)
class Receivers:
    """What a camera sees that light may fall on.

    Parameters
    ----------
    slices : ndarray of shape (S, 8, 3)
        Corners of slices of the frustum, widened by the lens, near to far, in world space.
    depths : ndarray of shape (S, 2)
        Of the slices, m.
    low, high : ndarray of shape (I, 3)
        World bounding boxes of the instances in view.
    nearest, farthest : ndarray of shape (I,)
        Their depths, m.
    """

    slices: np.ndarray
    depths: np.ndarray
    low: np.ndarray
    high: np.ndarray
    nearest: np.ndarray
    farthest: np.ndarray

    def box(self):
        """Return the lower and upper corner of all that is in view, in world space."""
        points = self.slices.reshape(-1, 3)
        low = np.maximum(points.min(axis=0), self.low.min(axis=0))
        high = np.minimum(points.max(axis=0), self.high.max(axis=0))
        return np.minimum(low, high), np.maximum(low, high)


def receivers_of(plan, corners, nearest, farthest):
    """Return what of a scene is in view.

    Parameters
    ----------
    plan : FramePlan
    corners : ndarray of shape (I, 8, 3)
        Of the bounding boxes of the instances in view, in world space; one at least.
    nearest, farthest : ndarray of shape (I,)
        Their depths, m.

    Returns
    -------
    Receivers
    """
    near, far = _clip_depths(plan)
    first = float(np.clip(nearest.min(), near, far))
    last = float(np.clip(farthest.max(), first * (1.0 + 1e-6), max(far, first * (1.0 + 1e-6))))
    count = 1
    if not plan.orthographic:
        ratio = np.log(last / first) / np.log(_SLICE_RATIO)
        count = int(np.clip(np.ceil(ratio), 1, MOST_SLICES))
    ends = np.geomspace(first, last, count + 1) if first > 0.0 else np.linspace(first, last, 2)
    depths = np.column_stack([ends[:-1], ends[1:]])
    return Receivers(
        slices=np.stack([_slice_corners(plan, *pair) for pair in depths]),
        depths=depths,
        low=corners.min(axis=1),
        high=corners.max(axis=1),
        nearest=nearest,
        farthest=farthest,
    )


def _clip_depths(plan):
    ends = np.linalg.inv(plan.projection) @ np.array([[0, 0, -1, 1], [0, 0, 1, 1]], float).T
    with np.errstate(divide="ignore"):
        depths = -ends[2] / ends[3]
    return depths[0], depths[1] if np.isfinite(depths[1]) else 1e10


def _slice_corners(plan, near, far):
    """Return the corners of a slice of the frustum as wide as any place on the lens sees it."""
    extent = 1.0 + np.abs(plan.jitter).max(axis=0, initial=0.0)
    found = []
    for depth in (near, far):
        shear = np.abs(depth - plan.focus_distance) / plan.focus_distance
        wider = plan.lens_extent * shear
        if plan.real_lens is not None:
            wider = wider + plan.real_lens.growth(np.array([depth]))[0]
        w = 1.0 if plan.orthographic else depth
        for y in (-extent[1], extent[1]):
            for x in (-extent[0], extent[0]):
                ray = plan.projection[:2]
                across = (x * w - ray[0, 3] + ray[0, 2] * depth) / ray[0, 0]
                up = (y * w - ray[1, 3] + ray[1, 2] * depth) / ray[1, 1]
                place = (across + np.sign(x) * wider[0], up + np.sign(y) * wider[1], -depth, 1.0)
                found.append((np.linalg.inv(plan.view) @ place)[:3])
    return np.array(found)


def turned(along, turn):
    """Return two axes across a direction, turned around it by a share of a whole turn."""
    start = np.array([1.0, 0.0, 0.0]) if abs(along[0]) < 0.8 else np.array([0.0, 1.0, 0.0])
    right = np.cross(along, start)
    right /= np.linalg.norm(right)
    up = np.cross(right, along)
    c, s = np.cos(2.0 * np.pi * turn), np.sin(2.0 * np.pi * turn)
    return c * right + s * up, c * up - s * right


def parallel_views(receivers, centers, radii, along, turn):
    """Return the views along parallel lines, one a slice, nearest first.

    Parameters
    ----------
    receivers : Receivers
    centers, radii : ndarray of shape (I, 3), (I,)
        Bounding spheres of all that hides light.
    along : ndarray of shape (3,)
        The way light travels, unit length.
    turn : float
        Of the maps around it, in whole turns.

    Returns
    -------
    list of LightView
    """
    axes = np.stack([*turned(along, turn), along])
    middle = 0.5 * (receivers.low + receivers.high) @ axes.T
    half = 0.5 * (receivers.high - receivers.low) @ np.abs(axes).T
    views = []
    for corners, depths in zip(receivers.slices, receivers.depths, strict=True):
        there = (receivers.farthest >= depths[0]) & (receivers.nearest <= depths[1])
        if not there.any():
            continue
        points = corners @ axes.T
        low = np.maximum(points.min(axis=0), (middle - half)[there].min(axis=0))
        high = np.minimum(points.max(axis=0), (middle + half)[there].max(axis=0))
        if (low > high).any():
            continue
        size = np.maximum(0.5 * (high - low)[:2], 1e-6) * 1.01
        center = 0.5 * (low + high)
        origin = center[0] * axes[0] + center[1] * axes[1] + high[2] * axes[2]
        view = LightView(origin, size[0] * axes[0], size[1] * axes[1], along, True, -1.0, 0.0)
        hiding = view.sees(centers, radii)
        depth = (centers - origin) @ along - radii
        near = min(float(depth[hiding].min(initial=0.0)), float(low[2] - high[2]))
        margin = 1e-3 * max(-near, size.max())
        made = (view.across, view.up, along, True, near - margin, margin)
        views.append(LightView(origin, *made))
    return views


def lamp_views(receivers, place, turn, cone=None):
    """Return the views from a place on a lamp.

    Parameters
    ----------
    receivers : Receivers
    place : ndarray of shape (3,)
    turn : ndarray of shape (3,)
        Of the maps, in whole turns.
    cone : tuple of ndarray of shape (3,) and float, optional
        Direction of a beam, unit length, and the tangent of its half angle: nothing outside of it
        is lit.

    Returns
    -------
    list of LightView
        None where the lamp lights nothing in view.
    """
    low, high = receivers.box()
    choice = np.array(np.meshgrid((0, 1), (0, 1), (0, 1), indexing="ij")).reshape(3, 8).T
    offsets = np.where(choice == 0, low, high) - place
    far = float(np.linalg.norm(offsets, axis=1).max()) * _WIDER + 1e-6
    near = _NEAREST * far
    best = None
    inside = ((place >= low) & (place <= high)).all()
    toward = offsets.mean(axis=0)
    if not inside and np.linalg.norm(toward) > 0.0:
        along = toward / np.linalg.norm(toward)
        right, up = turned(along, turn[0])
        depth = offsets @ along
        if depth.min() > 0.0:
            wide, high_ = (np.abs(offsets @ axis / depth).max() * _WIDER for axis in (right, up))
            best = max(wide, high_), along, wide * right, high_ * up
    if cone is not None and cone[1] < (best[0] if best else np.inf):
        right, up = turned(cone[0], turn[0])
        best = cone[1], cone[0], cone[1] * right, cone[1] * up
    if best is not None and best[0] <= _WIDEST:
        _, along, across, up = best
        least = 1e-6
        across = across * max(1.0, least / np.linalg.norm(across))
        up = up * max(1.0, least / np.linalg.norm(up))
        return [LightView(place, across, up, along, False, near, far)]
    axes = rotation(turn)
    views = []
    for face in range(6):
        # The faces of one cube fit together.
        along = axes[:, face % 3] * (1.0 if face < 3 else -1.0)
        right, up = (axes[:, (face + i) % 3] * (1.0 + _OVERLAP) for i in (1, 2))
        view = LightView(place, right, up, along, False, near, far)
        if _meets(view, offsets) and (cone is None or _in_beam(along, cone)):
            views.append(view)
    return views


def _meets(view, offsets):
    """Whether a box, by its corners from the view's origin, may be in the view."""
    depth = offsets @ view.along
    if (depth <= 0.0).all():
        return False
    for axis in (view.across, view.up):
        place = offsets @ axis / (axis @ axis)
        if (place > depth).all() or (-place > depth).all():
            return False
    return True


def _in_beam(along, cone):
    """Whether a face of a cube may be in a beam; its corners are 55 degrees from its middle."""
    angle = np.arccos(np.clip(along @ cone[0], -1.0, 1.0))
    return angle <= np.arctan(cone[1]) + np.radians(56.0)


def tiles(count, corner, side):
    """Divide a tile of the atlas among views.

    Parameters
    ----------
    count : int
    corner : tuple of 2 int
        Texels.
    side : int
        Of the tile, texels.

    Returns
    -------
    list of tuple of 4 int
        x, y, width, height.
    """
    across, down = _LAYOUTS[count]
    width, height = side // across, side // down
    x, y = corner
    return [
        (x + width * (i % across), y + height * (i // across), width, height) for i in range(count)
    ]
