"""Keeps textures and frame buffers alive until the drawing thread can free them.

Python drops an object wherever its last reference goes, and collects cycles in whichever thread
happens to allocate. A texture that is freed in a thread without a graphics context leaves its
number in Blender's list of what is bound; the next texture with that number then counts as bound
when it is not, and reads as 0. So everything of that kind is held here, and what nobody else refers
to is dropped by the thread that draws.
"""

import atexit
import sys
import threading

_held = []
_FEW = 64
# How many were left when they were last looked at.
_left = 0
_owner = None


def own():
    """Make this thread the one that draws and that frees textures."""
    global _owner
    _owner = threading.get_ident()


def keep(thing):
    """Hold an object until `let_go` finds that nothing else refers to it.

    Parameters
    ----------
    thing : object

    Returns
    -------
    list
        With the object, and empty when it has been let go.
    """
    holder = [thing]
    _held.append(holder)
    return holder


def let_go():
    """Free textures that nothing else refers to; only the drawing thread does."""
    if threading.get_ident() != _owner:
        return
    global _left
    # Frame buffers hold textures: repeat until nothing more goes.
    count = -1
    while count != len(_held):
        count = len(_held)
        for holder in _held:
            if is_orphan(holder):
                holder.clear()
        _held[:] = [holder for holder in _held if holder]
    _left = len(_held)


def let_go_now_and_then():
    """Free textures as `let_go` does, where half as many again have come since that was done.

    For what is done many times a frame: looking at all of them each time would take longer than
    drawing, where a frame holds thousands.
    """
    if len(_held) > 1.5 * _left + _FEW:
        let_go()


def is_orphan(holder):
    """Whether only a holder refers to its object.

    Parameters
    ----------
    holder : list
        With one object.

    Returns
    -------
    bool
    """
    return sys.getrefcount(holder[0]) <= _ALONE


# `sys.getrefcount` of an object that only a holder refers to: how many references the call itself
# makes depends on the interpreter.
_ALONE = sys.maxsize
_ALONE = next(sys.getrefcount(holder[0]) for holder in [[object()]])

# The device goes before Python does when the process ends; nothing of it may outlive it.
atexit.register(_held.clear)
