// Circle of confusion over a 3D view: near red, in focus green, far blue.
// Inputs: depth_tx (depth buffer of the view, 0 to 1, with an origin); from_clip (the view's clip space
// to the camera's space, at any scale); origin (lower left corner of the depth in the target, px);
// optics (x: focus distance; y: reach, the diameter in px at an unbounded distance times m, for a parallel
// projection at twice the focus distance; z: acceptable diameter, px; w: 1 for a parallel projection).
// Outputs: colour, its alpha not multiplied in. Source: methods 1; `sampling.thin_lens.DepthOfField`.

// Diameter over the acceptable one at which the colour is full.
const float FULL = 16.0;
const float OPACITY_SHARP = 0.4;
const vec2 OPACITY_BLURRED = vec2(0.4, 0.8);
const vec3 NEAR = vec3(1.0, 0.12, 0.05);
const vec3 SHARP = vec3(0.1, 0.9, 0.2);
const vec3 FAR = vec3(0.1, 0.3, 1.0);

void main()
{
  ivec2 texel = ivec2(gl_FragCoord.xy) - origin;
  float depth = texelFetch(depth_tx, texel, 0).x;
  vec2 place = (vec2(texel) + 0.5) / vec2(textureSize(depth_tx, 0));
  vec4 seen = from_clip * vec4(2.0 * vec3(place, depth) - 1.0, 1.0);
  float along = -seen.z / seen.w;
  // Nothing is there, or it lies behind the camera.
  if (depth >= 1.0 || along <= 0.0) {
    out_color = vec4(0.0);
    return;
  }
  float diameter = optics.w == 1.0 ? along / optics.x - 1.0 : 1.0 / optics.x - 1.0 / along;
  float share = optics.y * diameter / optics.z;
  float strength = clamp(log2(max(abs(share), 1.0)) / log2(FULL), 0.0, 1.0);
  vec3 color = share < 0.0 ? NEAR : FAR;
  bool sharp = abs(share) <= 1.0;
  float opacity = sharp ? OPACITY_SHARP : mix(OPACITY_BLURRED.x, OPACITY_BLURRED.y, strength);
  out_color = vec4(sharp ? SHARP : color, opacity);
}
