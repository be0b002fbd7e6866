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

#endif
