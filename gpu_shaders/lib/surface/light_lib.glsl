// Lights without shadows. A light is 7 texels of a row of the light table, from its second row on; kind 0
// is no light.
#ifndef LIGHT_LIB_GLSL
#define LIGHT_LIB_GLSL

#define LIGHT_NONE 0
#define LIGHT_SUN 1
#define LIGHT_POINT 2
#define LIGHT_SPOT 3
#define LIGHT_AREA 4

struct Light {
  int kind;
  vec3 position;   // world space, m
  vec3 radiance;   // sun: irradiance, W/m2; point and spot: intensity, W/sr; area: radiance
  float radius;    // m; sun: sine of the disk's half angle
  vec3 direction;  // the way the light travels, unit length
  float soft;      // 1: a disk that faces the shaded point; 0: a sphere
  float unsplit;   // 1: what surfaces reflect of it is never splatted as a highlight
  vec2 factors;    // of diffuse and specular light
  vec2 cone;       // spot: cosine of the half angle, 1 / width of the edge in cosines;
                   // area: tangent of half the spread, its normalisation (0 for all directions)
  vec3 axis_u;     // spot: scaled axes of the cone; area: unit axes of the rectangle
  vec3 axis_v;
  vec3 axis_w;
  vec2 half_size;  // area: of the rectangle, m
};

int light_count(sampler2D lights_tx)
{
  return int(texelFetch(lights_tx, ivec2(0, 0), 0).x + 0.5);
}

Light light_fetch(sampler2D lights_tx, int number)
{
  int row = number + 1;
  vec4 a = texelFetch(lights_tx, ivec2(0, row), 0);
  vec4 b = texelFetch(lights_tx, ivec2(1, row), 0);
  vec4 c = texelFetch(lights_tx, ivec2(2, row), 0);
  vec4 d = texelFetch(lights_tx, ivec2(3, row), 0);
  Light light;
  light.kind = int(a.w + 0.5);
  light.position = a.xyz;
  light.radiance = b.xyz;
  light.radius = b.w;
  light.direction = c.xyz;
  light.soft = mod(c.w, 2.0);
  light.unsplit = step(2.0, c.w);
  light.factors = d.xy;
  light.cone = d.zw;
  light.axis_u = vec3(0.0);
  light.axis_v = vec3(0.0);
  light.axis_w = vec3(0.0);
  light.half_size = vec2(0.0);
  if (light.kind >= LIGHT_SPOT) {
    vec4 u = texelFetch(lights_tx, ivec2(4, row), 0);
    vec4 v = texelFetch(lights_tx, ivec2(5, row), 0);
    light.axis_u = u.xyz;
    light.axis_v = v.xyz;
    light.half_size = vec2(u.w, v.w);
    light.axis_w = texelFetch(lights_tx, ivec2(6, row), 0).xyz;
  }
  return light;
}

// Irradiance of a sphere or a disk that faces the point, cut by the horizon, over that of the same
// light facing the surface. sin2: squared sine of its half angle.
// Snyder, Area light sources for real-time graphics, 1996; Lagarde and de Rousiers, SIGGRAPH 2014.
float horizon_cosine(float cosine, float sin2)
{
  if (cosine * cosine >= sin2) {
    return max(cosine, 0.0);
  }
  float sine = sqrt(max(1.0 - cosine * cosine, 1e-12));
  float x = sqrt(max(1.0 / sin2 - 1.0, 1e-12));
  float y = clamp(-x * cosine / sine, -1.0, 1.0);
  float w = sine * sqrt(max(1.0 - y * y, 0.0));
  float form = (cosine * acos(y) - x * w) * sin2 + atan(w / x);
  return max(form / (3.14159265358979 * sin2), 0.0);
}

// Factor of a spot's or an area light's beam in the direction `ray`, away from the light, at a distance.
float light_beam(Light light, vec3 ray, float distance)
{
  if (light.kind == LIGHT_SPOT) {
    vec3 local = vec3(dot(light.axis_u, ray), dot(light.axis_v, ray), dot(light.axis_w, ray));
    float z = local.z / max(length(local), 1e-12);
    // Each place on the lamp has a cone of its own: the edge is as much wider as its variance grows. That
    // of a smooth step is 1/20 of its width squared, that of a disk of radius r seen edge on r^2 / 4.
    float width = 1.0 / light.cone.y;
    float seen = sqrt(max(1.0 - z * z, 0.0)) * light.radius / max(distance, light.radius);
    float wider = sqrt(width * width + 5.0 * seen * seen);
    float t = clamp((z - light.cone.x - 0.5 * width) / wider + 0.5, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
  }
  if (light.kind == LIGHT_AREA) {
    float z = dot(light.direction, ray);
    if (z <= 0.0) {
      return 0.0;
    }
    if (light.cone.y > 0.0) {
      float tangent = sqrt(max(1.0 - z * z, 0.0)) / z;
      return max((light.cone.x - tangent) * light.cone.y, 0.0);
    }
  }
  return 1.0;
}

// Edge of a polygon seen from the origin: its share of the vector irradiance, times 2.
vec3 edge_irradiance(vec3 a, vec3 b)
{
  vec3 axis = cross(a, b);
  float sine = length(axis);
  return (sine > 1e-9) ? axis * (atan(sine, dot(a, b)) / sine) : vec3(0.0);
}

// Illumination of a point by a light: direction `towards` its middle, irradiance of a surface that
// faces it, squared sine of its half angle.
struct Illumination {
  vec3 towards;
  vec3 irradiance;
  float sin2;
};

Illumination light_illuminate(Light light, vec3 position)
{
  Illumination result = Illumination(-light.direction, light.radiance, light.radius * light.radius);
  if (light.kind == LIGHT_SUN) {
    return result;
  }
  vec3 offset = light.position - position;
  float distance2 = max(dot(offset, offset), 1e-12);
  vec3 towards = offset * inversesqrt(distance2);
  float beam = light_beam(light, -towards, sqrt(distance2));
  result.towards = towards;
  if (light.kind == LIGHT_AREA) {
    // Lambert's formula for a polygon; its direction is the mean direction of the light.
    vec3 u = light.axis_u * light.half_size.x, v = light.axis_v * light.half_size.y;
    vec3 a = normalize(offset - u - v), b = normalize(offset + u - v);
    vec3 c = normalize(offset + u + v), d = normalize(offset - u + v);
    vec3 flux = 0.5 * (edge_irradiance(a, b) + edge_irradiance(b, c) + edge_irradiance(c, d) +
                       edge_irradiance(d, a));
    float size = length(flux);
    if (size > 0.0) {
      result.towards = (dot(flux, towards) < 0.0) ? -flux / size : flux / size;
    }
    result.irradiance = light.radiance * (size * beam);
    result.sin2 = min(size / 3.14159265358979, 0.9999);
    return result;
  }
  float radius2 = light.radius * light.radius;
  float reach2 = (light.soft > 0.5) ? distance2 + radius2 : max(distance2, radius2);
  result.irradiance = light.radiance * (beam / reach2);
  result.sin2 = min(radius2 / reach2, 0.9999);
  return result;
}

// The direction into a light that a mirror would show, or the nearest to it. Karis, Real shading in
// Unreal Engine 4, SIGGRAPH 2013 course (representative point).
vec3 light_representative(Light light, Illumination light_in, vec3 position, vec3 mirrored)
{
  if (light.kind == LIGHT_AREA) {
    vec3 offset = light.position - position;
    float facing = dot(mirrored, light.direction);
    float t = (facing < -1e-4) ? dot(offset, light.direction) / facing : 1e4;
    vec3 local = mirrored * t - offset;
    vec2 place = clamp(vec2(dot(local, light.axis_u), dot(local, light.axis_v)),
                       -light.half_size,
                       light.half_size);
    return normalize(offset + light.axis_u * place.x + light.axis_v * place.y);
  }
  float cosine = dot(mirrored, light_in.towards);
  float cos_light = sqrt(1.0 - light_in.sin2);
  if (cosine >= cos_light) {
    return mirrored;
  }
  vec3 aside = mirrored - cosine * light_in.towards;
  float size = length(aside);
  if (size < 1e-7) {
    return light_in.towards;
  }
  return normalize(cos_light * light_in.towards + sqrt(light_in.sin2) * (aside / size));
}

#endif
