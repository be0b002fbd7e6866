// Blender's nodes that change colours: blend modes, hue and saturation, gamma, brightness and contrast,
// hue-saturation-value and hue-saturation-lightness.
// Blend modes: W3C Compositing and Blending, and Blender's own formulas (manual, Mix Color node).
// Hue, saturation: Smith, Color gamut transform pairs, SIGGRAPH 1978.
#ifndef COLOR_NODES_LIB_GLSL
#define COLOR_NODES_LIB_GLSL
#include "lib/nodes/math_nodes_lib.glsl"

// Hue of a colour in turns, from its largest and smallest channel.
float color_hue(vec3 c, float largest, float range)
{
  if (range == 0.0) {
    return 0.0;
  }
  float sixth;
  if (c.r == largest) {
    sixth = (c.g - c.b) / range;
  }
  else if (c.g == largest) {
    sixth = 2.0 + (c.b - c.r) / range;
  }
  else {
    sixth = 4.0 + (c.r - c.g) / range;
  }
  return (sixth < 0.0) ? sixth / 6.0 + 1.0 : sixth / 6.0;
}

vec3 rgb_to_hsv(vec3 c)
{
  float largest = max(c.r, max(c.g, c.b));
  float range = largest - min(c.r, min(c.g, c.b));
  if (largest == 0.0 || range == 0.0) {
    return vec3(0.0, 0.0, largest);
  }
  return vec3(color_hue(c, largest, range), range / largest, largest);
}

vec3 hsv_to_rgb(vec3 hsv)
{
  if (hsv.y == 0.0) {
    return vec3(hsv.z);
  }
  float turn = (hsv.x == 1.0) ? 0.0 : hsv.x * 6.0;
  float sector = floor(turn);
  float f = turn - sector;
  float p = hsv.z * (1.0 - hsv.y);
  float q = hsv.z * (1.0 - hsv.y * f);
  float t = hsv.z * (1.0 - hsv.y * (1.0 - f));
  if (sector == 0.0) {
    return vec3(hsv.z, t, p);
  }
  if (sector == 1.0) {
    return vec3(q, hsv.z, p);
  }
  if (sector == 2.0) {
    return vec3(p, hsv.z, t);
  }
  if (sector == 3.0) {
    return vec3(p, q, hsv.z);
  }
  if (sector == 4.0) {
    return vec3(t, p, hsv.z);
  }
  return vec3(hsv.z, p, q);
}

vec3 rgb_to_hsl(vec3 c)
{
  float largest = max(c.r, max(c.g, c.b));
  float least = min(c.r, min(c.g, c.b));
  float light = min(0.5 * (largest + least), 1.0);
  float range = largest - least;
  if (range == 0.0) {
    return vec3(0.0, 0.0, light);
  }
  float saturation = range / ((light > 0.5) ? 2.0 - largest - least : largest + least);
  return vec3(color_hue(c, largest, range), saturation, light);
}

vec3 hsl_to_rgb(vec3 hsl)
{
  vec3 hue = vec3(abs(hsl.x * 6.0 - 3.0) - 1.0,
                  2.0 - abs(hsl.x * 6.0 - 2.0),
                  2.0 - abs(hsl.x * 6.0 - 4.0));
  float chroma = (1.0 - abs(2.0 * hsl.z - 1.0)) * hsl.y;
  return (clamp(hue, 0.0, 1.0) - 0.5) * chroma + hsl.z;
}

vec3 blend_mix(vec3 a, vec3 b, float t)
{
  return mix(a, b, t);
}

vec3 blend_darken(vec3 a, vec3 b, float t)
{
  return mix(a, min(a, b), t);
}

vec3 blend_lighten(vec3 a, vec3 b, float t)
{
  return mix(a, max(a, b), t);
}

vec3 blend_multiply(vec3 a, vec3 b, float t)
{
  return mix(a, a * b, t);
}

vec3 blend_add(vec3 a, vec3 b, float t)
{
  return a + t * b;
}

vec3 blend_subtract(vec3 a, vec3 b, float t)
{
  return a - t * b;
}

vec3 blend_divide(vec3 a, vec3 b, float t)
{
  return mix(mix(a, a / b, t), a, equal(b, vec3(0.0)));
}

vec3 blend_difference(vec3 a, vec3 b, float t)
{
  return mix(a, abs(a - b), t);
}

vec3 blend_exclusion(vec3 a, vec3 b, float t)
{
  return max(mix(a, a + b - 2.0 * a * b, t), 0.0);
}

vec3 blend_screen(vec3 a, vec3 b, float t)
{
  return 1.0 - (1.0 - t * b) * (1.0 - a);
}

vec3 blend_overlay(vec3 a, vec3 b, float t)
{
  vec3 dark = a * (1.0 - t + 2.0 * t * b);
  vec3 light = 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a);
  return mix(light, dark, lessThan(a, vec3(0.5)));
}

float blend_dodge(float a, float b, float t)
{
  float left = 1.0 - t * b;
  if (a == 0.0) {
    return 0.0;
  }
  return (left <= 0.0) ? 1.0 : min(a / left, 1.0);
}

vec3 blend_dodge(vec3 a, vec3 b, float t)
{
  return vec3(blend_dodge(a.r, b.r, t), blend_dodge(a.g, b.g, t), blend_dodge(a.b, b.b, t));
}

float blend_burn(float a, float b, float t)
{
  float kept = 1.0 - t + t * b;
  return (kept <= 0.0) ? 0.0 : clamp(1.0 - (1.0 - a) / kept, 0.0, 1.0);
}

vec3 blend_burn(vec3 a, vec3 b, float t)
{
  return vec3(blend_burn(a.r, b.r, t), blend_burn(a.g, b.g, t), blend_burn(a.b, b.b, t));
}

vec3 blend_soft_light(vec3 a, vec3 b, float t)
{
  vec3 screen = 1.0 - (1.0 - b) * (1.0 - a);
  return mix(a, (1.0 - a) * b * a + a * screen, t);
}

vec3 blend_linear_light(vec3 a, vec3 b, float t)
{
  return a + t * (2.0 * b - 1.0);
}

vec3 blend_hue(vec3 a, vec3 b, float t)
{
  vec3 hsv = rgb_to_hsv(b);
  if (hsv.y == 0.0) {
    return a;
  }
  return mix(a, hsv_to_rgb(vec3(hsv.x, rgb_to_hsv(a).yz)), t);
}

vec3 blend_saturation(vec3 a, vec3 b, float t)
{
  vec3 hsv = rgb_to_hsv(a);
  if (hsv.y == 0.0) {
    return a;
  }
  return hsv_to_rgb(vec3(hsv.x, mix(hsv.y, rgb_to_hsv(b).y, t), hsv.z));
}

vec3 blend_value(vec3 a, vec3 b, float t)
{
  vec3 hsv = rgb_to_hsv(a);
  return hsv_to_rgb(vec3(hsv.xy, mix(hsv.z, rgb_to_hsv(b).z, t)));
}

vec3 blend_color(vec3 a, vec3 b, float t)
{
  vec3 hsv = rgb_to_hsv(b);
  if (hsv.y == 0.0) {
    return a;
  }
  return mix(a, hsv_to_rgb(vec3(hsv.xy, rgb_to_hsv(a).z)), t);
}

vec3 color_hue_saturation(vec3 color, float hue, float saturation, float value, float t)
{
  vec3 hsv = rgb_to_hsv(color);
  hsv = vec3(fract(hsv.x + hue + 0.5), clamp(hsv.y * saturation, 0.0, 1.0), hsv.z * value);
  return max(mix(color, hsv_to_rgb(hsv), t), 0.0);
}

vec3 color_gamma(vec3 color, float gamma)
{
  if (gamma == 0.0) {
    return vec3(1.0);
  }
  vec3 raised = pow(max(color, vec3(0.0)), vec3(gamma));
  return mix(color, raised, greaterThan(color, vec3(0.0)));
}

vec3 color_contrast(vec3 color, float brightness, float contrast)
{
  return max(color * (1.0 + contrast) + (brightness - 0.5 * contrast), 0.0);
}

#endif
