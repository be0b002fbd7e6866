// Exclusive prefix sums over a table of numbers, in place: the sum before each number in its row;
// TOTALS (one group): the sum before each row.
// Inputs, outputs: keys_img; totals_img (rows in rows of SOURCE_COLUMNS); rows.
// Source: Hillis and Steele, Data parallel algorithms, CACM 29(12), 1986.

ivec2 row_texel(int row)
{
  return ivec2(row % SOURCE_COLUMNS, row / SOURCE_COLUMNS);
}

uint before_lane(int lane, uint own)
{
  sums[lane] = own;
  barrier();
  for (int reach = 1; reach < THREADS; reach *= 2) {
    uint left = lane >= reach ? sums[lane - reach] : 0u;
    barrier();
    sums[lane] += left;
    barrier();
  }
  return sums[lane] - own;
}

void main()
{
  int lane = int(gl_LocalInvocationID.x);
#ifdef TOTALS
  int each = (rows + THREADS - 1) / THREADS;
  int first = min(lane * each, rows), last = min(first + each, rows);
  uint sum = 0u;
  for (int row = first; row < last; row++) {
    sum += imageLoad(totals_img, row_texel(row)).x;
  }
  uint before = before_lane(lane, sum);
  for (int row = first; row < last; row++) {
    uint own = imageLoad(totals_img, row_texel(row)).x;
    imageStore(totals_img, row_texel(row), uvec4(before));
    before += own;
  }
#else
  int row = int(gl_WorkGroupID.x);
  const int each = SOURCE_COLUMNS / THREADS;
  uint sum = 0u;
  for (int i = 0; i < each; i++) {
    sum += imageLoad(keys_img, ivec2(lane * each + i, row)).x;
  }
  uint before = before_lane(lane, sum);
  if (lane == THREADS - 1) {
    imageStore(totals_img, row_texel(row), uvec4(before + sum));
  }
  for (int i = 0; i < each; i++) {
    ivec2 texel = ivec2(lane * each + i, row);
    uint own = imageLoad(keys_img, texel).x;
    imageStore(keys_img, texel, uvec4(before));
    before += own;
  }
#endif
}
