// Circle of confusion over a 3D view: near red, in focus green, far blue.
// Inputs: depth_tx (depth buffer of the view, 0 to 1, with an origin); from_clip (the view's clip space
// to the camera's space, at any scale); origin (lower left corner of the depth in the target, px);
// optics (x: focus distance; y: reach, the diameter in px at an unbounded distance times m, for a parallel
// projection at twice the focus distance; z: acceptable diameter, px; w: 1 for a parallel projection).
// Where nothing is, the world is: infinitely far in front of the camera.
// Outputs: colour, its alpha not multiplied in. Source: methods 1; `sampling.thin_lens.DepthOfField`.

// Diameters over the acceptable one: where green ends, and where the colour is full.
const float TURNED = 2.0;
const float FULL = 32.0;
const float OPACITY_SHARP = 0.35;
const float OPACITY_FULL = 0.6;
const vec3 NEAR = vec3(1.0, 0.12, 0.05);
const vec3 SHARP = vec3(0.1, 0.9, 0.2);
const vec3 FAR = vec3(0.1, 0.3, 1.0);
// m; stands for the world's distance.
const float INFINITE = 1e20;

// Distance along the optical axis of what is seen at a place, 0 to 1, and a depth of the view.
float distance_along(vec2 place, float depth)
{
  vec4 seen = from_clip * vec4(2.0 * vec3(place, depth) - 1.0, 1.0);
  return -seen.z / seen.w;
}

void main()
{
  ivec2 texel = ivec2(gl_FragCoord.xy) - origin;
  float depth = texelFetch(depth_tx, texel, 0).x;
  vec2 place = (vec2(texel) + 0.5) / vec2(textureSize(depth_tx, 0));
  float along = distance_along(place, depth);
  if (depth >= 1.0) {
    along = along > distance_along(place, 0.0) ? INFINITE : -INFINITE;
  }
  // It lies behind the camera.
  if (along <= 0.0) {
    out_color = vec4(0.0);
    return;
  }
  float diameter = optics.w == 1.0 ? along / optics.x - 1.0 : 1.0 / optics.x - 1.0 / along;
  float share = optics.y * diameter / optics.z;
  // Doublings of the acceptable diameter: at the limit the colour begins to turn.
  float beyond = log2(max(abs(share), 1.0));
  float turned = smoothstep(0.0, log2(TURNED), beyond);
  float strength = clamp(beyond / log2(FULL), 0.0, 1.0);
  vec3 color = share < 0.0 ? NEAR : FAR;
  out_color = vec4(mix(SHARP, color, turned), mix(OPACITY_SHARP, OPACITY_FULL, strength));
}
