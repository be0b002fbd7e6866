// Inside of a mark, with smooth edges; the blend state lays it over the others.
// Inputs: v_offset, v_size, v_color (see bokeh_marks_vert); mark_buf; OUTLINE, RING as there.
// Outputs: premultiplied scene-linear colour. Source: methods 10.

void main()
{
  float opacity = 1.0;
#if defined(RING)
  // Distance from an ellipse, to first order.
  float ratio = mark_buf.size.w;
  vec2 place = v_offset * vec2(ratio, 1.0);
  float radius = max(length(place), 1e-6);
  float slope = length(vec2(place.x * ratio, place.y)) / radius;
  float away = abs(radius - v_size) / max(slope, 1e-6) - mark_buf.size.y;
  opacity = mark_buf.size.z;
#else
  float away = max(abs(v_offset.x), abs(v_offset.y)) - v_size;
#ifdef OUTLINE
  away = abs(away) - mark_buf.size.y;
#endif
#endif
  float alpha = opacity * clamp(0.5 - away, 0.0, 1.0);
  out_color = vec4(v_color * alpha, alpha);
}
