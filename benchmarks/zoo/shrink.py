"""From a recipe that fails to a small one that still fails."""

import copy
import json
import time

# Whose items may go one by one; all other lists are numbers that belong together.
_LISTS = {
    *("objects", "lights", "layers", "collections", "materials", "modifiers"),
    *("uvs", "colors", "splines", "elements", "ramp", "keys"),
}
# Without these a part of a recipe means nothing, or something larger.
_KEPT_KEYS = {
    *("kind", "node", "type", "socket", "size"),
    *("render.resolution_x", "render.resolution_y", "render.engine"),
}
# Numbers that make a scene smaller by being smaller, and the least of each.
_HALVED = {"count": 1, "render.resolution_x": 4, "render.resolution_y": 4, "subdivisions": 1}


def shrink(recipe, fails, most_tries=200, seconds=120.0):
    """Return the smallest recipe that is found to fail.

    Parameters
    ----------
    recipe : dict
        One that fails.
    fails : callable
        Whether a recipe fails as this one does.
    most_tries : int
        How many recipes are tried at most.
    seconds : float
        After which none is tried any more.

    Returns
    -------
    recipe : dict
    tries : int
    """
    end = time.monotonic() + seconds
    tries, known = 0, set()
    while True:
        for smaller in reductions(recipe):
            text = json.dumps(smaller, sort_keys=True)
            if text in known:
                continue
            if tries == most_tries or time.monotonic() > end:
                return recipe, tries
            known.add(text)
            tries += 1
            if fails(smaller):
                recipe = smaller
                break
        else:
            return recipe, tries


def reductions(recipe):
    """Give smaller recipes, those first that leave out most.

    Parameters
    ----------
    recipe : dict

    Yields
    ------
    dict
    """
    found = []
    for path, value in _walk(recipe, ()):
        if _may_go(recipe, path):
            found.append((len(json.dumps(value)), path, None))
        if isinstance(value, dict) and "node" in value:
            for inner in _inner_nodes(value):
                gain = len(json.dumps(value)) - len(json.dumps(inner))
                found.append((gain, path, inner))
        least = _HALVED.get(path[-1]) if path else None
        if least is not None and isinstance(value, int) and value > least:
            # Small pictures make every other try fast.
            found.append((100 * value, path, max(least, value // 2)))
    found.sort(key=lambda entry: -entry[0])
    yield from _without_many(recipe)
    for _, path, replacement in found:
        yield _changed(recipe, path, replacement)


def _without_many(recipe):
    """Leave out halves and quarters of what holds many parts: objects, settings."""
    for path, value in _walk(recipe, ()):
        if not isinstance(value, dict | list):
            continue
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        keys = [key for key in keys if _may_go(recipe, (*path, key))]
        for parts in (1, 2, 4):
            size = -(-len(keys) // parts)
            if size > 1:
                for first in range(0, len(keys), size):
                    yield _without(recipe, path, keys[first : first + size])


def _without(recipe, path, keys):
    changed = copy.deepcopy(recipe)
    place = changed
    for step in path:
        place = place[step]
    for key in reversed(keys):
        del place[key]
    return changed


def _walk(value, path):
    items = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    for key, inner in items:
        yield (*path, key), inner
        yield from _walk(inner, (*path, key))


def _may_go(recipe, path):
    *way, last = path
    if isinstance(last, str):
        return last not in _KEPT_KEYS
    return bool(way) and way[-1] in _LISTS


def _inner_nodes(spec):
    for value in (*spec.get("inputs", {}).values(), spec.get("inner")):
        if isinstance(value, dict) and "node" in value:
            yield value


def _changed(recipe, path, replacement):
    changed = copy.deepcopy(recipe)
    *way, last = path
    place = changed
    for step in way:
        place = place[step]
    if replacement is None:
        del place[last]
    else:
        place[last] = copy.deepcopy(replacement)
    return changed
