// A mark for each highlight, where a pinhole at the lens' centre sees it: a dot, the OUTLINE of the
// square of pixels that it stands for, or the RING that is its disc's edge, piece by piece.
// Inputs: pos (corner, 0 or 1); sources_a_tx, sources_b_tx (see highlights_comp); view_buf (of the
// frame), mark_buf; stride (2 marks every second highlight, ...). FATES: tiles_tx, states_tx (see
// bokeh_culling_tiles_comp); colours are those of the highlight's fate. SHARP: only highlights whose
// circle of confusion is too small to be splatted have a mark. Otherwise colours are the highlights' own.
// Outputs: place from the mark's middle, px (v_offset), size (v_size), colour (v_color).
// Source: methods 10.
#include "lib/lens_lib.glsl"
#include "lib/bokeh/mark_lib.glsl"

#define PI 3.14159265358979

void main()
{
#ifdef RING
  int index = gl_InstanceID / RING_PIECES * stride;
#else
  int index = gl_InstanceID * stride;
#endif
  ivec2 texel = list_texel(index);
  vec4 a = texelFetch(sources_a_tx, texel, 0);
  float coc = abs(coc_radius_px(a.z, view_buf.lens));
  vec4 clip = view_buf.projection * vec4(a.xy, -a.z, 1.0);
  vec2 center = (clip.xy / clip.w * 0.5 + 0.5) * view_buf.film.xy;
  float line = mark_buf.size.y;
#if defined(FATES)
  int fate = fate_of(texelFetch(tiles_tx, texel, 0).w, texelFetch(states_tx, texel, 0).w);
  v_color = mark_buf.colors[fate].rgb;
#elif defined(SHARP)
  v_color = mark_buf.colors[FATE_SHARP].rgb;
#else
  vec3 light = texelFetch(sources_b_tx, texel, 0).rgb;
  v_color = light / max(max(light.r, max(light.g, light.b)), 1e-30);
#endif
#if defined(RING)
  v_size = coc;
  float ratio = mark_buf.size.w;
  float angle = 2.0 * PI * (float(gl_InstanceID % RING_PIECES) + pos.x) / float(RING_PIECES);
  // The pieces are straight: their chords lie inside the ring.
  float margin = (line + 1.0) * max(ratio, 1.0);
  float reach = (coc + margin) / cos(PI / float(RING_PIECES));
  float radius = mix(max(coc - margin, 0.0), reach, pos.y);
  v_offset = radius * vec2(cos(angle) / ratio, sin(angle));
#else
#ifdef OUTLINE
  v_size = max(0.5 * a.w, mark_buf.size.x);
#else
  v_size = mark_buf.size.x;
#endif
  v_offset = (pos * 2.0 - 1.0) * (v_size + line + 1.0);
#endif
#ifdef SHARP
  if (coc > mark_buf.source.x) {
    // No mark: a triangle without area.
    v_offset = vec2(0.0);
  }
#endif
  gl_Position = vec4((center + v_offset) / view_buf.film.xy * 2.0 - 1.0, 0.0, 1.0);
}
