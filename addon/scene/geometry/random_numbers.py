"""The random numbers that nodes may ask of an object and of an instance, as Cycles makes them."""


def share_of_range(number):
    """Return a number of 32 bits as a share of the largest."""
    return number / 0xFFFFFFFF


def object_number(name):
    """Return the number, of 32 bits, from which nodes draw the random number of an object.

    As Cycles does: the characters of the name as a number to the base 37, hashed by Jenkins'
    *lookup3* (public domain, 2006) together with 0.
    """
    key = 0
    for character in name.encode():
        # Signed characters.
        key = (key * 37 + (character - 256 if character > 127 else character)) & 0xFFFFFFFF
    mask = 0xFFFFFFFF
    a = b = c = (0xDEADBEEF + (2 << 2) + 13) & mask
    a = (a + key) & mask

    def turned(x, k):
        return ((x << k) | (x >> (32 - k))) & mask

    c = ((c ^ b) - turned(b, 14)) & mask
    a = ((a ^ c) - turned(c, 11)) & mask
    b = ((b ^ a) - turned(a, 25)) & mask
    c = ((c ^ b) - turned(b, 16)) & mask
    a = ((a ^ c) - turned(c, 4)) & mask
    b = ((b ^ a) - turned(a, 14)) & mask
    return ((c ^ b) - turned(b, 24)) & mask
