"""Choice of the level of detail of every instance and lens sample, by its blur (methods 3).

The level is a real number: at 2.3 the first 70 % of a frame's lens samples draw level 2, the rest
level 3. Any contiguous part of the sample sequence covers the lens evenly, so both levels are
blurred alike, and nothing pops when the number changes.

References
----------
Jeong, Kim and Lee, CGF 2013, section 4.
"""

from dataclasses import dataclass

import numpy as np

# Least bias, subtracted from every level. Without it a triangle is as large as the circle of
# confusion, so that a blurred silhouette keeps its shape; but vertex attributes are blurred by the
# triangles, too, and that blur should be small beside the lens'.
LEAST_ALLOWANCE = 0.5
# Bias of objects with highlights. Highlights are found at full detail, but taken out of the samples
# at the level that these draw: where levels blur colours or shading, more or less light is taken
# out than is splatted. On a ball that mirrors lamps a bias of 1.5 left an error of 0.06 % of the
# picture's light, 3 less than rounding.
_HIGHLIGHT_ALLOWANCE = 3.0

# Least triangles of a graded mesh: smaller ones save less than their own draw calls cost.
LEAST_GRADED_TRIANGLES = 10_000

# Share of a mesh' triangles that face the camera.
_FACING_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class Extents:
    """Depth ranges and bounding spheres of the instances, seen from the camera.

    Parameters
    ----------
    nearest, farthest : ndarray of shape (I,)
        Least and largest depth of the corners of the bounding box, m.
    center_depth, radius : ndarray of shape (I,)
        Of the bounding sphere of those corners, m.
    inverse_focus : ndarray of shape (2, I) or None
        Least and largest inverse of the focus distance of any wavelength, 1/m; None without
        chromatic aberration.
    """

    nearest: np.ndarray
    farthest: np.ndarray
    center_depth: np.ndarray
    radius: np.ndarray
    inverse_focus: np.ndarray | None = None


def extents(boxes, view, chromatic=None):
    """Return depth ranges and bounding spheres of the instances for a camera.

    Parameters
    ----------
    boxes : InstanceBoxes
    view : ndarray of shape (4, 4)
        World to camera space.
    chromatic : ChromaticPlan or None

    Returns
    -------
    Extents
    """
    ahead, reach = boxes.range_along(-view[2, :3])
    depth = ahead - view[2, 3]
    focus = None
    if chromatic is not None:
        eye = boxes.corners() @ view[:3, :3].T + view[:3, 3]
        focus = chromatic.ranges(eye).inverse_focus
    return Extents(
        nearest=depth - reach,
        farthest=depth + reach,
        center_depth=depth,
        radius=boxes.radii,
        inverse_focus=focus,
    )


def coc_radius(depth, plan):
    """Return the signed radius of the circle of confusion in pixels, along the vertical."""
    defocus = plan.coc_scale * (depth - plan.focus_distance) / plan.focus_distance
    return defocus if plan.orthographic else defocus / np.maximum(depth, 1e-9)


def coc_ends(near, far, plan, inverse_focus=None):
    """Return the signed circles of confusion at the ends of depth ranges.

    Parameters
    ----------
    near, far : ndarray of shape (...)
        In m.
    plan : FramePlan
    inverse_focus : ndarray of shape (2, ...) or None
        As of `Extents`.

    Returns
    -------
    near, far : ndarray of shape (...)
        In pixels; with chromatic aberration the least and the largest of all wavelengths.
    """
    if inverse_focus is None:
        return coc_radius(near, plan), coc_radius(far, plan)
    depth = np.stack([near, far])[:, None]
    if plan.orthographic:
        radii = depth * inverse_focus - 1.0
    else:
        radii = inverse_focus - 1.0 / np.maximum(depth, 1e-9)
    radii = plan.coc_scale * radii
    return radii.min(axis=(0, 1)), radii.max(axis=(0, 1))


def blur_for_levels(mesh, *levels):
    """Return the blur that hides the errors of each level of detail of a mesh.

    Parameters
    ----------
    mesh : MeshSnapshot
        Full detail.
    *levels : MeshLevel
        From level 1 up.

    Returns
    -------
    ndarray of shape (L,)
        Rising; expressed as a level of detail by the size of triangles: see `choose_levels`.
    """
    low, high = np.asarray(mesh.bounds, np.float64)
    radius = np.linalg.norm(high - low) / 2.0
    triangle = np.pi * radius**2 / max(_FACING_SHARE * len(mesh.triangles), 1e-9)
    wanted = []
    for number, level in enumerate(levels, 1):
        measured = np.pi / 4.0 * level.errors.blur**2 / max(triangle, 1e-300)
        wanted.append(max(number + LEAST_ALLOWANCE, np.log2(max(measured, 1e-300))))
    return np.maximum.accumulate(wanted) if wanted else np.zeros(0)


def allowed_levels(chosen, wanted):
    """Limit levels to those whose errors the blur hides.

    Parameters
    ----------
    chosen : ndarray of shape (I,)
        Levels by the size of triangles alone.
    wanted : ndarray of shape (L,)
        See `blur_for_levels`.

    Returns
    -------
    ndarray of shape (I,)
        From 0 to L; fractional between the blurs of two levels.
    """
    if len(wanted) == 0:
        return np.zeros(len(chosen))
    # Levels with the same blur follow one another at once.
    steps = np.append(wanted[0] - 1.0, wanted) + 1e-6 * np.arange(len(wanted) + 1)
    return np.interp(chosen, steps, np.arange(len(wanted) + 1.0))


def choose_levels(seen, triangles, plan, bias=0.0):
    """Choose the level of detail of every instance by its blur and the size of its triangles.

    Parameters
    ----------
    seen : Extents
    triangles : ndarray of shape (I,)
        Number of triangles at full detail.
    plan : FramePlan
    bias : float or ndarray of shape (I,)
        Subtracted from the level.

    Returns
    -------
    ndarray of shape (I,)
        By the size of triangles alone; not negative, 0 where a part is in focus or behind the
        camera.
    """
    front = (seen.nearest > 0.0) | plan.orthographic
    depths = (np.where(front, depth, 1.0) for depth in (seen.nearest, seen.farthest))
    smallest = _smallest(*coc_ends(*depths, plan, seen.inverse_focus), plan)
    level = _level(smallest, seen, triangles, plan) - bias
    return np.where(front, np.maximum(level, 0.0), 0.0)


def may_grade(seen, triangles, plan):
    """Return which instances may be drawn with a graded mesh.

    Parameters
    ----------
    seen : Extents
    triangles : ndarray of shape (I,)
        Of the mesh at full detail.
    plan : FramePlan

    Returns
    -------
    ndarray of shape (I,)
        bool; large ones, partly blurred enough for a coarser level of detail.
    """
    near = np.where(plan.orthographic, seen.nearest, np.maximum(seen.nearest, 1e-9))
    ends = coc_ends(near, np.maximum(seen.farthest, near), plan, seen.inverse_focus)
    level = _level(np.abs(ends).max(axis=0), seen, triangles, plan)
    level -= plan.level_bias + LEAST_ALLOWANCE
    reaches = plan.orthographic | (seen.farthest > 0.0)
    return (triangles >= LEAST_GRADED_TRIANGLES) & reaches & (level >= 1.0)


def _level(radius, seen, triangles, plan):
    """Return the level whose triangles are as large as circles of confusion; may be negative."""
    blur_area = np.pi * radius**2 * _narrowing(plan)
    scale = plan.projection[1, 1] * plan.height / 2.0
    size = scale * seen.radius
    if not plan.orthographic:
        size = size / np.maximum(seen.center_depth, 1e-9)
    triangle_area = np.pi * size**2 / np.maximum(_FACING_SHARE * triangles, 1e-9)
    ratio = blur_area / np.maximum(triangle_area, 1e-30)
    return np.log2(np.maximum(ratio, 1e-30))


def blurred_area(depth, world, plan, bias):
    """Return the largest area of triangles that the blur hides, at each vertex of an instance.

    Seen at an average angle, a triangle of that area covers as much of the picture as the circle of
    confusion, or less by the bias.

    Parameters
    ----------
    depth : ndarray of shape (V,)
        Of its vertices, m.
    world : ndarray of shape (4, 4)
        Object to world space.
    plan : FramePlan
    bias : float
        Levels of detail.

    Returns
    -------
    ndarray of shape (V,)
        Area in object space; 0 in focus or behind the camera.
    """
    front = (depth > 0.0) | plan.orthographic
    ahead = np.where(front, depth, 1.0)
    focus = plan.chromatic.overall().inverse_focus[:, None] if plan.chromatic else None
    circle = np.pi * _smallest(*coc_ends(ahead, ahead, plan, focus), plan) ** 2 * _narrowing(plan)
    scale = plan.projection[1, 1] * plan.height / 2.0
    pixels = np.full(len(depth), scale) if plan.orthographic else scale / ahead
    # Mean over all directions of the scaling and foreshortening of an area.
    stretch = np.abs(np.linalg.det(world[:3, :3])) ** (2.0 / 3.0) * 0.5
    area = circle / np.maximum(pixels**2 * stretch, 1e-30)
    return np.where(front, area * 2.0**-bias, 0.0)


def _smallest(near, far, plan):
    smallest = np.where(near * far <= 0.0, 0.0, np.minimum(np.abs(near), np.abs(far)))
    # A real lens may blur less than a thin one: its focus is elsewhere off the axis.
    return np.maximum(smallest - plan.blur_doubt, 0.0)


def _narrowing(plan):
    # An anamorphic opening is narrower than it is high.
    return plan.lens_extent[0] / max(plan.lens_extent[1], 1e-30)


def level_for_sample(levels, sample, samples):
    """Return the whole level that each instance is drawn at for one lens sample.

    Parameters
    ----------
    levels : ndarray of shape (I,)
    sample, samples : int
        Index of the sample, and number of samples.

    Returns
    -------
    ndarray of shape (I,)
        int64.
    """
    lower = np.floor(levels)
    coarser = sample >= np.round((1.0 - (levels - lower)) * samples)
    return (lower + coarser).astype(np.int64)


def allowances(content, plan):
    """Return the level bias of every instance for the sake of its highlights.

    Parameters
    ----------
    content : SceneContent
    plan : FramePlan

    Returns
    -------
    ndarray of shape (I,)
    """
    found = np.zeros(len(content.instances.world))
    uneven = plan.bokeh.uneven if plan.bokeh else ()
    for number, group in enumerate(content.groups):
        if number in uneven:
            found[group.first : group.first + group.count] = _HIGHLIGHT_ALLOWANCE
    return found


def meshes_with_levels(content, plan):
    """Return the meshes whose levels of detail a frame needs, whole or as graded meshes.

    Parameters
    ----------
    content : SceneContent
    plan : FramePlan

    Returns
    -------
    list of int
        Uids, in the order of the content.
    """
    if plan.level_bias is None or plan.coc_scale == 0.0:
        return []
    # The plain frame of Fringe is drawn with the same levels.
    beside = set(meshes_with_levels(content, plan.plain)) if plan.plain else set()
    meshes = [content.meshes[group.mesh] for group in content.groups]
    large = [len(mesh.triangles) >= 2 * plan.least_triangles for mesh in meshes]
    if not any(large):
        return [uid for uid in content.meshes if uid in beside]
    seen = extents(content.boxes, plan.view, plan.chromatic)
    full = np.array([len(mesh.triangles) for mesh in meshes], float)[content.group_of]
    bias = plan.level_bias + LEAST_ALLOWANCE + allowances(content, plan)
    chosen = choose_levels(seen, full, plan, bias)
    coarser = (chosen > 0.0) | may_grade(seen, full, plan)
    of_groups = np.bincount(content.group_of, weights=coarser, minlength=len(meshes)) > 0
    wanted = {meshes[number].uid for number in np.flatnonzero(large & of_groups)}
    return [uid for uid in content.meshes if uid in wanted | beside]
