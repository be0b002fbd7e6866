// Image-based lighting: an equirectangular image, and a strip of octahedral maps of its mean over GGX
// lobes, one a level of roughness, and last over the cosine lobe of a diffuse surface.
#ifndef ENVIRONMENT_LIB_GLSL
#define ENVIRONMENT_LIB_GLSL

#define ENVIRONMENT_PI 3.14159265358979
// Must agree with passes/surface/environment.py.
#define ENVIRONMENT_LEVELS 8
#define ENVIRONMENT_TILES 9.0
#define ENVIRONMENT_DIFFUSE 8.0
#define ENVIRONMENT_TILE 128.0
// Gutter around each map, texels, that repeats its other side, so that filtering stays in the map.
#define ENVIRONMENT_GUTTER 1.0

// Blender's equirectangular mapping: +x in the middle of the image, z up.
vec2 direction_to_equirect(vec3 direction)
{
  float longitude = atan(direction.y, direction.x);
  float latitude = atan(direction.z, length(direction.xy));
  return vec2(0.5 - longitude / (2.0 * ENVIRONMENT_PI), latitude / ENVIRONMENT_PI + 0.5);
}

vec3 equirect_to_direction(vec2 uv)
{
  float longitude = (0.5 - uv.x) * 2.0 * ENVIRONMENT_PI;
  float latitude = (uv.y - 0.5) * ENVIRONMENT_PI;
  return vec3(cos(longitude) * cos(latitude), sin(longitude) * cos(latitude), sin(latitude));
}

vec2 sign_not_zero(vec2 v)
{
  return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
}

// Octahedral map in [-1, 1]; Cigolle et al., JCGT 3(2), 2014.
vec2 direction_to_octahedron(vec3 direction)
{
  vec3 d = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
  return (d.z >= 0.0) ? d.xy : (1.0 - abs(d.yx)) * sign_not_zero(d.xy);
}

vec3 octahedron_to_direction(vec2 place)
{
  vec3 d = vec3(place, 1.0 - abs(place.x) - abs(place.y));
  if (d.z < 0.0) {
    d.xy = (1.0 - abs(d.yx)) * sign_not_zero(d.xy);
  }
  return normalize(d);
}

// Mean of the surroundings over the lobe of a tile.
vec3 environment_level(sampler2D levels_tx, vec2 octahedron, float tile)
{
  float inner = ENVIRONMENT_TILE - 2.0 * ENVIRONMENT_GUTTER;
  vec2 texel = (octahedron * 0.5 + 0.5) * inner + ENVIRONMENT_GUTTER;
  vec2 uv = vec2((tile * ENVIRONMENT_TILE + texel.x) / (ENVIRONMENT_TILE * ENVIRONMENT_TILES),
                 texel.y / ENVIRONMENT_TILE);
  return texture(levels_tx, uv).rgb;
}

#endif
