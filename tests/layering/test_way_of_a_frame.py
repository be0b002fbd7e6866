"""A frame goes one way through the rooms: by the imports, which no step can do without."""

from .test_imports import OWN, room

# The way of a frame (docs/architecture.md): rooms by the step in which it enters them.
WAY = (
    ("scene",),
    ("snapshot",),
    ("engine.planning",),
    ("engine.frame",),
    ("engine.bokeh", "engine.layered"),
    ("engine.visibility",),
    ("engine.drawing",),
    ("engine.sharing",),
    ("passes",),
    ("device",),
)
# Rooms of values and arithmetic, which every step may ask: the values that a snapshot consists of,
# and bounds and errors of levels of detail. Which level a lens sample is drawn at is chosen when it
# is drawn, because only then is it known which samples share its round.
ASKED_ANYWHERE = {"snapshot", "levels", "levels.making"}


def step_of(name):
    """Return the step in which a frame enters a room, or None if it does not."""
    for step, rooms in enumerate(WAY):
        if any(name == top or name.startswith(f"{top}.") for top in rooms):
            return step
    return None


def test_a_frame_never_climbs_back():
    climbing = set()
    for found in OWN:
        here, there = room(found.module), room(found.target)
        first, then = step_of(here), step_of(there)
        if None in (first, then) or there in ASKED_ANYWHERE:
            continue
        if then < first:
            climbing.add((found.module, found.target))
    assert climbing == set()
