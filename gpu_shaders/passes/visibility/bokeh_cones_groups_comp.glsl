// Finds the instances of a group of transparent surfaces that meet the cone from a source to the lens,
// by the bounding box of their mesh, after bokeh_cones_comp. Counts them for each source; FILL writes
// pairs where prefix sums place them, so that transmittances multiply in a fixed order. EDGES as there.
// Inputs: sources_tx; instances_tx; visibility_buf; count; extent (x, y: first and last row of the
// group's instances; z: first row of keys; w: place in the table of counts); box_low, box_high (corners
// of the mesh); culls (0: sources that are decided are tested, too); FILL: states_tx, keys_tx,
// totals_tx, window (places: first and number).
// Outputs: keys_img (pairs of a source), counts_img, states_img; FILL: pairs_img: source, row of the
// instance table.
// Source: methods 10 (J20 section 4.3.3).
#include "lib/surface/instance_lib.glsl"
#include "passes/visibility/bokeh_cones_source.glsl"

void main()
{
  int index = int(gl_GlobalInvocationID.x);
#ifdef EDGES
  ConeSource own = source_of_thread(index, 0);
#else
  ConeSource own = source_of_thread(index, extent.z);
  Met met = nothing_met();
#endif
  if (!own.tested) {
    return;
  }
  vec3 far = max(abs(box_low.xyz), abs(box_high.xyz));
  for (int row = extent.x; row <= extent.y; row++) {
    mat4 matrix = visibility_buf.view * instance_world(instances_tx, row);
    LensView view = lens_view_in(own.view, matrix, far);
    if (!meets_box(view, box_low.xyz, box_high.xyz)) {
      continue;
    }
#ifdef EDGES
    vec4 record = own.record;
    record.w = STATE_OPEN;
    imageStore(states_img, own.texel, record);
    return;
#else
#ifdef FILL
    uint within = own.place - uint(window.x) + met.found;
    if (within < uint(window.y)) {
      imageStore(pairs_img, list_texel(int(within)), vec4(index, row, 0.0, 0.0));
    }
    met.found++;
#else
    vec3 sides = box_high.xyz - box_low.xyz;
    sides *= vec3(length(matrix[0]), length(matrix[1]), length(matrix[2]));
    float area = max(sides.x * sides.y, max(sides.y * sides.z, sides.z * sides.x));
    meet(met, view, own.source, own.side, area, box_low.xyz, box_high.xyz, visibility_buf);
#endif
#endif
  }
#if !defined(FILL) && !defined(EDGES)
  imageStore(keys_img, own.key, uvec4(met.found));
  if (met.found > 0u) {
    imageAtomicAdd(counts_img, ivec2(extent.w, 0), met.found);
  }
  vec4 record = record_after(own.record, met, own.source, false, visibility_buf);
  imageStore(states_img, own.texel, record);
#endif
}
