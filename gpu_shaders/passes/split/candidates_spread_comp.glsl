// Copies marks of tiles, each also to its eight neighbours: what a raster sees of small surfaces
// may lie beside what it missed.
// Inputs: marks_tx (0: not marked).
// Outputs: candidates_img (1 where a tile is marked, or beside one that is).
void main()
{
  ivec2 tile = ivec2(gl_GlobalInvocationID.xy), size = textureSize(marks_tx, 0);
  if (any(greaterThanEqual(tile, size))) {
    return;
  }
  bool marked = false;
  for (int i = 0; i < 9; i++) {
    ivec2 at = clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), size - 1);
    marked = marked || texelFetch(marks_tx, at, 0).x != 0u;
  }
  imageStore(candidates_img, tile, uvec4(marked ? 1u : 0u));
}
