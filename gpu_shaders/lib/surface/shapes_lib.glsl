// Shapes of broad reflection besides Lambert's: rough diffuse surfaces, sheen, toon, hair.
// A shape tells how much of a lamp's light is reflected, a surroundings' share, and where most of it
// comes from. SHAPES: a surface has others than Lambert's.
// Rough: Fujii's model with the compensation of Portsmouth, Kutz and Hill, EON, 2024. Velvet: Ashikhmin,
// Distribution-based BRDFs, 2007. Hair: Marschner et al., 2003, with Lorentz lobes. Microfiber sheen
// (Zeltner, Burley and Chiang, 2022): fits to what Cycles gives.
#ifndef SHAPES_LIB_GLSL
#define SHAPES_LIB_GLSL

#define SHAPE_LAMBERT 0
#define SHAPE_ROUGH 1       // x: roughness, y: mean of the colour
#define SHAPE_TOON 2        // x: angle of full light, y: of the edge, radians
#define SHAPE_TOON_GLOSSY 3 // the same
#define SHAPE_MICROFIBER 4  // x: roughness
#define SHAPE_VELVET 5      // x: roughness
#define SHAPE_HAIR 6        // x, y: roughness along and around, z: offset, radians
#define SHAPE_HAIR_THROUGH 7
#define SHAPE_FOG 8         // x: how much further ahead than back it scatters (Henyey and Greenstein, 1941)

#define SHAPE_PI 3.14159265358979

struct Shape {
  int kind;
  vec4 numbers;
  vec3 tangent;
};

// Share of uniform light that the first order of a rough surface reflects (FON's albedo).
float rough_albedo(float cosine, float roughness)
{
  float c = clamp(cosine, 1e-3, 1.0), s = sqrt(1.0 - c * c);
  float g = s * (acos(c) - s * c) + 2.0 / 3.0 * ((s / c) * (1.0 - s * s * s) - s);
  return (1.0 + roughness * g / SHAPE_PI) / (1.0 + (0.5 - 2.0 / (3.0 * SHAPE_PI)) * roughness);
}

// What light reflected more than once adds, over what both directions lack.
float rough_repeats(float roughness, float color)
{
  float first = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * SHAPE_PI)) * roughness);
  float mean = first * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * SHAPE_PI)) * roughness);
  float c = clamp(color, 0.0, 1.0);
  return c * c * mean / max((1.0 - c * (1.0 - mean)) * (1.0 - mean), 1e-4);
}

float rough_response(vec3 normal, vec3 view, vec3 towards, vec4 numbers)
{
  float l = dot(normal, towards), v = max(dot(normal, view), 1e-3);
  if (l <= 0.0) {
    return 0.0;
  }
  float r = numbers.x;
  float s = dot(view, towards) - l * v;
  float t = (s > 0.0) ? max(l, v) : 1.0;
  float first = (1.0 + r * s / t) / (1.0 + (0.5 - 2.0 / (3.0 * SHAPE_PI)) * r);
  float more = rough_repeats(r, numbers.y) * (1.0 - rough_albedo(l, r)) * (1.0 - rough_albedo(v, r));
  return l * (first + more) / SHAPE_PI;
}

// 1 within an angle, falling to 0 over an edge.
float toon_step(float cosine, vec4 numbers)
{
  float angle = acos(clamp(cosine, -1.0, 1.0));
  return 1.0 - clamp((angle - numbers.x) / max(numbers.y, 1e-6), 0.0, 1.0);
}

float toon_end(vec4 numbers)
{
  return min(numbers.x + numbers.y, 0.5 * SHAPE_PI);
}

float microfiber_albedo(float c, float roughness)
{
  float q = 1.0 / clamp(roughness, 0.07, 1.0);
  vec3 p = vec3(1.0, q, q * q);
  float log_albedo = dot(p, vec3(-0.1814, -0.1282, 0.0454)) +
                     c * (dot(p, vec3(0.2001, -0.7883, -0.3201)) +
                          c * dot(p, vec3(1.1863, -1.0408, -0.0492)));
  // Below a roughness of 0.07 there is none.
  return exp(min(log_albedo, 0.0)) * clamp(roughness / 0.07, 0.0, 1.0);
}

float velvet_albedo(float c, float roughness)
{
  float q = 1.0 / clamp(roughness, 0.1, 1.0);
  vec3 p = vec3(1.0, q, q * q);
  float log_albedo = dot(p, vec3(0.0016, -0.1365, 0.0358)) +
                     c * (dot(p, vec3(-0.0194, 0.2857, -0.2607)) +
                          c * dot(p, vec3(0.614, -2.2452, 0.0776)));
  return exp(min(log_albedo, 0.0)) * clamp(roughness / 0.1, 0.0, 1.0);
}

float velvet_response(vec3 normal, vec3 view, vec3 towards, float roughness)
{
  float l = dot(normal, towards), v = dot(normal, view);
  vec3 h = normalize(towards + view);
  float nh = dot(normal, h), hv = abs(dot(view, h));
  float sine2 = 1.0 - nh * nh;
  if (l <= 0.0 || v <= 1e-4 || nh > 1.0 - 1e-5 || hv < 1e-5) {
    return 0.0;
  }
  float sigma = max(roughness, 0.01), inverse2 = 1.0 / (sigma * sigma);
  float spread = exp(-nh * nh / sine2 * inverse2) * inverse2 / (SHAPE_PI * sine2 * sine2);
  float hidden = min(1.0, 2.0 * nh / hv * min(v, l));
  return 0.25 * spread * hidden / v;
}

// A strand along the tangent: Lorentz lobes of the angle along it and around it.
float hair_response(Shape shape, vec3 normal, vec3 view, vec3 towards)
{
  vec3 t = shape.tangent;
  float sin_v = dot(t, view), sin_l = dot(t, towards);
  float cos_l = sqrt(max(1.0 - sin_l * sin_l, 1e-6));
  vec3 across_v = view - sin_v * t, across_l = towards - sin_l * t;
  float cos_phi = dot(across_v, across_l) * inversesqrt(max(dot(across_v, across_v) *
                                                            dot(across_l, across_l), 1e-12));
  float phi = acos(clamp(cos_phi, -1.0, 1.0));
  float theta_v = asin(clamp(sin_v, -1.0, 1.0)), theta_l = asin(clamp(sin_l, -1.0, 1.0));
  float sigma = max(shape.numbers.x, 1e-3), around = clamp(shape.numbers.y, 1e-3, 1.0);
  float from = atan((0.5 * (0.5 * SHAPE_PI + theta_v) - shape.numbers.z) / sigma);
  float to = atan((0.5 * (-0.5 * SHAPE_PI + theta_v) - shape.numbers.z) / sigma);
  float off = 0.5 * (theta_l + theta_v) - shape.numbers.z;
  float along = sigma / (2.0 * (off * off + sigma * sigma) * (from - to) * cos_l);
  bool through = dot(normal, towards) < 0.0;
  if (shape.kind == SHAPE_HAIR_THROUGH) {
    float c = cos(0.5 * phi), d = SHAPE_PI - phi;
    float wide = atan(0.5 * SHAPE_PI / around) * 2.0;
    return through ? along * 2.0 * around / (wide * (d * d + around * around)) : 0.0;
  }
  if (through || phi > SHAPE_PI * around) {
    return 0.0;
  }
  return along * 0.25 * cos(0.5 * phi / around) / around;
}

// A lamp's light reflected towards the eye, over its irradiance of a surface that faces it.
float shape_response(Shape shape, vec3 normal, vec3 view, vec3 towards)
{
  if (shape.kind == SHAPE_ROUGH) {
    return rough_response(normal, view, towards, shape.numbers);
  }
  if (shape.kind == SHAPE_TOON || shape.kind == SHAPE_TOON_GLOSSY) {
    bool glossy = shape.kind == SHAPE_TOON_GLOSSY;
    vec3 axis = glossy ? 2.0 * dot(normal, view) * normal - view : normal;
    float above = step(0.0, dot(normal, towards));
    float wide = 2.0 * SHAPE_PI * (1.0 - cos(toon_end(shape.numbers)));
    return above * toon_step(dot(axis, towards), shape.numbers) / max(wide, 1e-6);
  }
  if (shape.kind == SHAPE_MICROFIBER) {
    float albedo = microfiber_albedo(max(dot(normal, view), 0.0), shape.numbers.x);
    return albedo * max(dot(normal, towards), 0.0) / SHAPE_PI;
  }
  if (shape.kind == SHAPE_VELVET) {
    return velvet_response(normal, view, towards, shape.numbers.x);
  }
  if (shape.kind == SHAPE_FOG) {
    float g = clamp(shape.numbers.x, -0.99, 0.99);
    float spread = 1.0 + g * g + 2.0 * g * dot(towards, view);
    return (1.0 - g * g) / (4.0 * SHAPE_PI * spread * sqrt(spread));
  }
  return hair_response(shape, normal, view, towards);
}

// Share of uniform surroundings that is reflected.
float shape_albedo(Shape shape, float cos_view)
{
  vec4 n = shape.numbers;
  if (shape.kind == SHAPE_ROUGH) {
    // Of uniform light, the mean over its directions is what is lacking on the whole.
    float first = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * SHAPE_PI)) * n.x);
    float mean = first * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * SHAPE_PI)) * n.x);
    float own = rough_albedo(cos_view, n.x);
    return own + rough_repeats(n.x, n.y) * (1.0 - mean) * (1.0 - own);
  }
  if (shape.kind == SHAPE_TOON || shape.kind == SHAPE_TOON_GLOSSY) {
    float e = toon_end(n), m = min(n.x, e), soft = max(n.y, 1e-6);
    float cap = 1.0 - cos(e) * (1.0 - (e - m) / soft) - (sin(e) - sin(m)) / soft;
    float share = cap / max(1.0 - cos(e), 1e-6);
    if (shape.kind == SHAPE_TOON_GLOSSY) {
      // What of the cone lies above the surface.
      share *= 0.5 + 0.5 * clamp(asin(clamp(cos_view, 0.0, 1.0)) / e, 0.0, 1.0);
    }
    return share;
  }
  if (shape.kind == SHAPE_MICROFIBER) {
    return microfiber_albedo(cos_view, n.x);
  }
  return (shape.kind == SHAPE_VELVET) ? velvet_albedo(cos_view, n.x) : 1.0;
}

#endif
