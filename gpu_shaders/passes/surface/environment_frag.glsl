// Prefilters an equirectangular image over GGX lobes and a cosine lobe: octahedral maps in a row,
// rougher to the right, the cosine lobe last, each with a gutter that repeats its other side.
// Inputs: level_0_tx .. level_5_tx, the image and its halvings (equirectangular, scene linear);
// moment_x_tx, moment_y_tx, moment_z_tx, light times its direction in cells of the image, and in alpha that
// of an even world.
// Outputs: scene-linear colour.
// Source: Krivanek and Colbert, GPU Gems 3, chapter 20; Karis, SIGGRAPH 2013 course.
#include "lib/surface/bsdf_lib.glsl"
#include "lib/surface/environment_lib.glsl"
#include "lib/surface/texture_lib.glsl"

#define SAMPLES 64

vec3 equirect_radiance(sampler2D tx, vec2 uv)
{
  // Columns repeat, rows end at the poles.
  float margin = 0.5 / float(textureSize(tx, 0).y);
  return image_linear(tx, vec2(uv.x, clamp(uv.y, margin, 1.0 - margin)), EXTENSION_REPEAT).rgb;
}

vec3 source_level(int level, vec2 uv)
{
  switch (level) {
    case 0:
      return equirect_radiance(level_0_tx, uv);
    case 1:
      return equirect_radiance(level_1_tx, uv);
    case 2:
      return equirect_radiance(level_2_tx, uv);
    case 3:
      return equirect_radiance(level_3_tx, uv);
    case 4:
      return equirect_radiance(level_4_tx, uv);
    default:
      return equirect_radiance(level_5_tx, uv);
  }
}

vec3 source_radiance(vec3 direction, float level)
{
  vec2 uv = direction_to_equirect(direction);
  float l = clamp(level, 0.0, 5.0);
  int lower = int(floor(l));
  return mix(source_level(lower, uv), source_level(min(lower + 1, 5), uv), l - float(lower));
}

// Second coordinate of the Hammersley set.
float radical_inverse(uint i)
{
  uint bits = i;
  bits = (bits << 16u) | (bits >> 16u);
  bits = ((bits & 0x55555555u) << 1u) | ((bits & 0xaaaaaaaau) >> 1u);
  bits = ((bits & 0x33333333u) << 2u) | ((bits & 0xccccccccu) >> 2u);
  bits = ((bits & 0x0f0f0f0fu) << 4u) | ((bits & 0xf0f0f0f0u) >> 4u);
  bits = ((bits & 0x00ff00ffu) << 8u) | ((bits & 0xff00ff00u) >> 8u);
  return float(bits >> 8u) * (1.0 / 16777216.0);
}

// Mean of the image over the cosine lobe, summed over all cells.
vec3 diffuse_mean(vec3 normal)
{
  ivec2 size = textureSize(moment_x_tx, 0);
  vec4 sum = vec4(0.0);
  for (int y = 0; y < size.y; y++) {
    for (int x = 0; x < size.x; x++) {
      ivec2 cell = ivec2(x, y);
      vec4 facing = normal.x * texelFetch(moment_x_tx, cell, 0) +
                    normal.y * texelFetch(moment_y_tx, cell, 0) +
                    normal.z * texelFetch(moment_z_tx, cell, 0);
      sum += max(facing, 0.0);
    }
  }
  return sum.rgb / max(sum.a, 1e-6);
}

void main()
{
  float tile = floor(gl_FragCoord.x / ENVIRONMENT_TILE);
  float roughness = min((tile + 1.0) / float(ENVIRONMENT_LEVELS), 1.0);
  float alpha = roughness * roughness;
  vec2 texel = vec2(gl_FragCoord.x - tile * ENVIRONMENT_TILE, gl_FragCoord.y) - ENVIRONMENT_GUTTER;
  vec2 place = texel / (ENVIRONMENT_TILE - 2.0 * ENVIRONMENT_GUTTER) * 2.0 - 1.0;
  // A texel beyond an edge of the square is one inside, mirrored along that edge.
  if (abs(place.x) > 1.0) {
    place = vec2(sign(place.x) * 2.0 - place.x, -place.y);
  }
  if (abs(place.y) > 1.0) {
    place = vec2(-place.x, sign(place.y) * 2.0 - place.y);
  }
  vec3 normal = octahedron_to_direction(place);
  if (tile > ENVIRONMENT_DIFFUSE - 0.5) {
    out_color = vec4(diffuse_mean(normal), 1.0);
    return;
  }
  vec3 up = (abs(normal.z) < 0.9) ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 tangent = normalize(cross(up, normal));
  vec3 bitangent = cross(normal, tangent);
  vec2 size = vec2(textureSize(level_0_tx, 0));
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int i = 0; i < SAMPLES; i++) {
    float u = (float(i) + 0.5) / float(SAMPLES);
    float angle = 2.0 * PI * radical_inverse(uint(i));
    float cos_h = sqrt((1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u));
    float sin_h = sqrt(max(1.0 - cos_h * cos_h, 0.0));
    vec3 h = tangent * (sin_h * cos(angle)) + bitangent * (sin_h * sin(angle)) + normal * cos_h;
    vec3 light = 2.0 * cos_h * h - normal;
    float cosine = dot(normal, light);
    if (cosine > 0.0) {
      // Solid angle of the sample over that of a texel of the image in this direction.
      float density = ggx_distribution(cos_h, alpha) * 0.25;
      float texel_angle = 2.0 * PI * PI / (size.x * size.y) *
                          max(length(light.xy), 1.0 / size.y);
      float level = 0.5 * log2(1.0 / (float(SAMPLES) * density * texel_angle)) + 0.5;
      sum += source_radiance(light, level) * cosine;
      weight += cosine;
    }
  }
  out_color = vec4(sum / max(weight, 1e-6), 1.0);
}
