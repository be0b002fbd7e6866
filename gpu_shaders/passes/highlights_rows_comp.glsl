// Where each pixel's highlights begin in the list: prefix sums, in an order that is always the same.
// Without TOTALS: along each row, in place, as highlights_comp reads it; rows_img gets each row's sums.
// TOTALS, one group: over the rows, in place, after those that count_img counts already; it gets the
// number of highlights so far (0, 0) and of those too sharp to be splatted (1, 0).
// Inputs: counts_img (see highlights_comp), size (columns, rows, layers).
// Outputs: counts_img, rows_img (row, layer: highlights; row, layers + layer: sharp ones), count_img.
// Source: methods 9.

#ifdef TOTALS
void main()
{
  int rows = size.y * size.z;
  int lane = int(gl_LocalInvocationID.x);
  int each = (rows + THREADS - 1) / THREADS;
  int first = min(lane * each, rows), last = min(first + each, rows);
  uvec2 sum = uvec2(0u);
  for (int i = first; i < last; i++) {
    sum.x += imageLoad(rows_img, ivec2(i % size.y, i / size.y)).x;
    sum.y += imageLoad(rows_img, ivec2(i % size.y, size.z + i / size.y)).x;
  }
  sums[lane] = sum;
  barrier();
  uvec2 before = uvec2(imageLoad(count_img, ivec2(0, 0)).x, imageLoad(count_img, ivec2(1, 0)).x);
  // All have read it before one writes it.
  barrier();
  for (int i = 0; i < lane; i++) {
    before += sums[i];
  }
  if (lane == THREADS - 1) {
    imageStore(count_img, ivec2(0, 0), uvec4(before.x + sum.x));
    imageStore(count_img, ivec2(1, 0), uvec4(before.y + sum.y));
  }
  for (int i = first; i < last; i++) {
    ivec2 texel = ivec2(i % size.y, i / size.y);
    uint count = imageLoad(rows_img, texel).x;
    imageStore(rows_img, texel, uvec4(before.x));
    before.x += count;
  }
}
#else
void main()
{
  int row = int(gl_GlobalInvocationID.x);
  int layer = int(gl_GlobalInvocationID.y);
  if (row >= size.y) {
    return;
  }
  uint found = 0u, sharp = 0u;
  for (int x = 0; x < size.x; x++) {
    ivec3 texel = ivec3(x, row, layer);
    uint count = imageLoad(counts_img, texel).x;
    imageStore(counts_img, texel, uvec4(found << 2u | (count & 3u)));
    found += count & 255u;
    sharp += count >> 8u;
  }
  imageStore(rows_img, ivec2(row, layer), uvec4(found));
  imageStore(rows_img, ivec2(row, size.z + layer), uvec4(sharp));
}
#endif
