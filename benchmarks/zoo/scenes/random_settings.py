"""Values of properties within the ranges that they declare, drawn by walking their RNA."""

import math

from addon.engine.shared_resources import shelf
from addon.lens_io.glasses.glass_catalog import catalog_names

# What only costs time where it is large: how far a check goes. Nothing else of the picture depends
# on how many samples there are, but for the noise. Errors below the least take thousands.
MOST = {
    "render_samples": 96,
    "subsamples": 24,
    "render_min_samples": 64,
    "render_max_samples": 256,
}
LEAST = {"render_error": 0.02}


def draw_settings(rng, group, prefix=""):
    """Draw a value for every property of a group that a user can set.

    Parameters
    ----------
    rng : random.Random
    group : bpy.types.PropertyGroup
    prefix : str
        Path of the group, with a dot at its end.

    Returns
    -------
    dict of str to object
        By path, in the order of the declarations; groups within the group are walked, too.
    """
    values = {}
    for prop in group.bl_rna.properties:
        name = prop.identifier
        if name in {"rna_type", "name"} or prop.is_hidden:
            continue
        if prop.type == "POINTER":
            inner = getattr(group, name)
            if inner is not None and inner.bl_rna.base and inner.id_data == group.id_data:
                values |= draw_settings(rng, inner, f"{prefix}{name}.")
            elif prop.fixed_type.identifier == "Image" and rng.random() < 0.2:
                values[prefix + name] = draw_image(rng)
        elif not prop.is_readonly:
            value = draw_value(rng, prop)
            if value is not None:
                values[prefix + name] = value
    return values


def draw_value(rng, prop):
    """Draw a value of a property, or None where there is none to draw.

    Parameters
    ----------
    rng : random.Random
    prop : bpy.types.Property

    Returns
    -------
    bool, int, float, str, list or None
    """
    if prop.type == "BOOLEAN":
        return rng.random() < 0.5
    if prop.type == "ENUM":
        # A menu that is filled when it opens has no items here.
        items = [item.identifier for item in prop.enum_items]
        if prop.is_enum_flag or not items:
            return None
        return rng.choice(items)
    if prop.type == "STRING":
        return _draw_text(rng, prop)
    if prop.type not in {"INT", "FLOAT"}:
        return None
    if getattr(prop, "is_array", False):
        return [_draw_number(rng, prop) for _ in range(prop.array_length)]
    return _draw_number(rng, prop)


def _draw_text(rng, prop):
    if prop.identifier == "lens":
        return rng.choice(["", *shelf().ids()])
    if prop.identifier == "glass":
        return rng.choice(sorted(catalog_names()))
    return None


def _draw_number(rng, prop):
    low, high = prop.hard_min, prop.hard_max
    most, least = MOST.get(prop.identifier), LEAST.get(prop.identifier)
    high = high if most is None else min(high, most)
    low = low if least is None else max(low, least)
    soft_low = min(max(prop.soft_min, low), high)
    soft_high = max(min(prop.soft_max, high), low)
    kind = rng.random()
    if kind < 0.2:
        value = min(max(prop.default, low), high)
    elif kind < 0.35:
        value = rng.choice([low, high])
    elif kind < 0.5:
        value = rng.choice([soft_low, soft_high])
    elif kind < 0.6:
        value = _between(rng, low, high)
    else:
        value = _between(rng, soft_low, soft_high)
    # Rounding must not leave the range.
    return int(value) if prop.type == "INT" else min(max(round_value(value), low), high)


def _between(rng, low, high):
    """Draw evenly, or by magnitude where the range spans many."""
    if low >= 0.0 and high > 100.0 * max(low, 1.0):
        least = max(low, 1e-3)
        return math.exp(rng.uniform(math.log(least), math.log(high)))
    return rng.uniform(low, high)


def draw_image(rng, largest=40):
    """Draw the recipe of an image: byte or float, any size, of any colour space.

    Parameters
    ----------
    rng : random.Random
    largest : int
        Longest side, in pixels.

    Returns
    -------
    dict
        For `pieces.make_image`.
    """
    spec = {
        "size": [rng.choice([1, 2, 3, 7, 16, rng.randint(1, largest)]) for _ in range(2)],
        "seed": rng.randrange(1000),
    }
    if rng.random() < 0.5:
        spec["float"] = True
        spec["bright"] = rng.choice([1.0, 3.0, 3.0, 50.0, around(rng, 50.0, 2000.0)])
    if rng.random() < 0.3:
        spec["alpha"] = True
    if rng.random() < 0.3:
        spec["space"] = rng.choice(["Non-Color", "sRGB", "Linear Rec.709"])
    return spec


def round_value(value):
    """Keep four digits, so that scripts are read with ease."""
    return float(f"{value:.4g}")


def around(rng, low, high):
    """Draw a number by magnitude, rounded."""
    return round_value(math.exp(rng.uniform(math.log(low), math.log(high))))


def even(rng, low, high):
    """Draw a number evenly, rounded."""
    return round_value(rng.uniform(low, high))
