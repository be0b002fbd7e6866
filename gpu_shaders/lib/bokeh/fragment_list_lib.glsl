// Lists of the fragments of each texel of a raster; numbers count from 1 where 0 is the end of a
// list.
#ifndef FRAGMENT_LIST_LIB_GLSL
#define FRAGMENT_LIST_LIB_GLSL

// Bits of a texel's coordinate; the bit that marks opaque surfaces.
#define KEY_BITS 15
#define KEY_OPAQUE 0x80000000u
// Marks the head of a list that has been sorted.
#define IN_ORDER 0x80000000u

ivec2 list_texel(uint index)
{
  return ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
}

uint fragment_key(ivec2 texel, bool opaque)
{
  return uint(texel.x) | uint(texel.y) << KEY_BITS | (opaque ? KEY_OPAQUE : 0u);
}

ivec2 key_texel(uint key)
{
  uint mask = (1u << KEY_BITS) - 1u;
  return ivec2(key & mask, key >> KEY_BITS & mask);
}

#endif
