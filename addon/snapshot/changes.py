"""Differences between two snapshots, found by comparing them."""

from enum import Flag, auto

import numpy as np


class Change(Flag):
    """Parts of a snapshot that differ."""

    NONE = 0
    GEOMETRY = auto()
    TRANSFORMS = auto()
    MATERIALS = auto()
    IMAGES = auto()
    LIGHTS = auto()
    WORLD = auto()
    # Which meshes are drawn, how often, with which materials.
    GROUPS = auto()
    REPORT = auto()
    CAMERA = auto()
    FILM = auto()
    SAMPLING = auto()
    PASSES = auto()
    CONTENT = GEOMETRY | TRANSFORMS | MATERIALS | IMAGES | LIGHTS | WORLD | GROUPS | REPORT
    # Lens samples that were drawn before no longer belong to the picture: sampling restarts.
    PICTURE = CONTENT & ~REPORT | CAMERA | FILM | SAMPLING | PASSES
    ALL = CONTENT | CAMERA | FILM | SAMPLING | PASSES


def compare_content(old, new):
    """Return how two `SceneContent` differ.

    Meshes, images and materials are compared by uid, which is a promise of equal content.

    Parameters
    ----------
    old, new : SceneContent or None
        None has nothing in common with any.

    Returns
    -------
    Change
    """
    if old is new:
        return Change.NONE
    if old is None or new is None:
        return Change.CONTENT
    change = Change.NONE
    for name, flag in (
        ("meshes", Change.GEOMETRY),
        ("materials", Change.MATERIALS),
        ("images", Change.IMAGES),
    ):
        if getattr(old, name).keys() != getattr(new, name).keys():
            change |= flag
    if not same_instances(old.instances, new.instances):
        change |= Change.TRANSFORMS
    for name, flag in (
        ("groups", Change.GROUPS),
        ("lights", Change.LIGHTS),
        ("world", Change.WORLD),
        ("report", Change.REPORT),
    ):
        if getattr(old, name) != getattr(new, name):
            change |= flag
    if (old.unseen is None) != (new.unseen is None):
        return change | Change.GROUPS
    return change if old.unseen is None else change | compare_content(old.unseen, new.unseen)


def compare(old, new):
    """Return how two `SceneSnapshot` differ.

    Parameters
    ----------
    old, new : SceneSnapshot or None

    Returns
    -------
    Change
    """
    if old is new:
        return Change.NONE
    if old is None or new is None:
        return Change.ALL
    change = compare_content(old.content, new.content)
    if not same_camera(old.camera, new.camera):
        change |= Change.CAMERA
    if old.film != new.film:
        change |= Change.FILM
    if old.sampling != new.sampling:
        change |= Change.SAMPLING
    if (old.passes, old.layer_name, old.alpha_threshold) != (
        new.passes,
        new.layer_name,
        new.alpha_threshold,
    ):
        change |= Change.PASSES
    return change


def same_instances(old, new):
    """Whether two `InstanceTable` hold the same rows, bit by bit."""
    return old is new or (
        _same_array(old.world, new.world)
        # Bits: an identifier may be any float.
        and _same_array(old.cryptomatte_id.view(np.int32), new.cryptomatte_id.view(np.int32))
        and _same_array(old.previous_world, new.previous_world)
        and _same_array(old.next_world, new.next_world)
        and _same_array(old.looks, new.looks)
        and old.names == new.names
    )


def same_camera(old, new):
    """Whether two `Camera` take the same picture."""
    return (
        _same_array(old.view, new.view)
        and _same_array(old.projection, new.projection)
        and (old.lens, old.orthographic) == (new.lens, new.orthographic)
        and old.bokeh == new.bokeh
        # What is sharp all over shows no lens.
        and (new.lens is None or _glass(old) == _glass(new))
        and (old.chromatic, old.field_radius) == (new.chromatic, new.field_radius)
        and _same_pose(old.previous, new.previous)
        and _same_pose(old.next, new.next)
    )


def _glass(camera):
    """Return what bends a camera's rays beside a thin lens."""
    return camera.real_lens, camera.artist, camera.artist and camera.f_number


def _same_pose(old, new):
    if old is None or new is None:
        return old is new
    return all(_same_array(a, b) for a, b in zip(old, new, strict=True))


def _same_array(old, new):
    if old is None or new is None:
        return old is new
    return old is new or np.array_equal(old, new)
