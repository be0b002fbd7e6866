"""Cryptomatte identifiers: a name hashed into a float that survives image formats.

MurmurHash3 x86 32-bit with seed 0 of the UTF-8 name; the bits are taken as a float32 whose exponent
is never all zeros or all ones, so that it is neither denormal, infinite nor not-a-number.

References
----------
Friedman and Jones, *Fully automatic ID mattes with support for motion blur and transparency*,
SIGGRAPH 2015; Cryptomatte specification 1.2.0, Psyop. Appleby, MurmurHash3, public domain.
"""

import struct
from functools import lru_cache

_MASK = 0xFFFFFFFF


def murmur3_32(key, seed=0):
    """Return the MurmurHash3 x86 32-bit hash of a byte string.

    Parameters
    ----------
    key : bytes
    seed : int

    Returns
    -------
    int
        0 to 2^32 - 1.
    """
    value = seed
    whole = len(key) & ~3
    for (block,) in struct.iter_unpack("<I", key[:whole]):
        value ^= _scramble(block)
        value = (_rotate_left(value, 13) * 5 + 0xE6546B64) & _MASK
    if whole < len(key):
        value ^= _scramble(int.from_bytes(key[whole:], "little"))
    value ^= len(key)
    value = ((value ^ (value >> 16)) * 0x85EBCA6B) & _MASK
    value = ((value ^ (value >> 13)) * 0xC2B2AE35) & _MASK
    return value ^ (value >> 16)


# Memo of the name alone: every frame has the same ones.
@lru_cache(maxsize=65536)
def cryptomatte_hash(name):
    """Return the 32 bits that stand for a name, as they are listed in a manifest.

    Parameters
    ----------
    name : str

    Returns
    -------
    int
    """
    bits = murmur3_32(name.encode(errors="surrogateescape"))
    exponent = bits >> 23 & 0xFF
    return bits ^ 1 << 23 if exponent in (0, 0xFF) else bits


def cryptomatte_id(name):
    """Return the float that stands for a name in a Cryptomatte pass.

    Parameters
    ----------
    name : str

    Returns
    -------
    float
        Exactly representable as float32.
    """
    return struct.unpack("<f", struct.pack("<I", cryptomatte_hash(name)))[0]


def _scramble(block):
    return (_rotate_left((block * 0xCC9E2D51) & _MASK, 15) * 0x1B873593) & _MASK


def _rotate_left(value, bits):
    return (value << bits | value >> (32 - bits)) & _MASK
