// Integer hashes for random decisions that must repeat exactly.
#ifndef HASH_LIB_GLSL
#define HASH_LIB_GLSL

// PCG output permutation; Jarzynski and Olano, Hash functions for GPU rendering, JCGT 9(3), 2020.
uint hash_uint(uint x)
{
  uint state = x * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

uint hash_combine(uint seed, uint x)
{
  return hash_uint(seed ^ (x + 0x9e3779b9u + (seed << 6u) + (seed >> 2u)));
}

// Uniform in [0, 1) from the top 24 bits, which a float holds exactly.
float hash_unit(uint x)
{
  return float(x >> 8u) * (1.0 / 16777216.0);
}

// A random permutation that keeps the nested order of bits below each; Laine and Karras, EGSR 2011, with
// the constants of Vegdahl.
uint hash_nested(uint x, uint seed)
{
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16u) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Number `index` of a sequence in [0, 1) of which every aligned block of 2^n numbers has one in each of 2^n
// equal parts. Sequences of two seeds have nothing to do with one another: both their order and their
// numbers are scrambled (Burley, Practical hash-based Owen scrambling, JCGT 9(4), 2020).
float hash_spread(uint index, uint seed)
{
  uint shuffled = hash_nested(bitfieldReverse(index), seed);
  return hash_unit(bitfieldReverse(hash_nested(bitfieldReverse(shuffled), hash_uint(seed))));
}

#endif
