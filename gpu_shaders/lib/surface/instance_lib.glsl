// The instance table: one texture, 256 instances a row, 6 texels an instance.
// Texels 0 to 2: rows of the object-to-world matrix. Texel 3, x: Cryptomatte id of the object; y, z:
// level of detail and share of shared drawings, for the pass that shows them. Texel 4: the object's colour.
// Texel 5, x: a random number of the instance, 0 to 1; y: the object's pass index.
#ifndef INSTANCE_LIB_GLSL
#define INSTANCE_LIB_GLSL

#define INSTANCES_PER_ROW 256
#define INSTANCE_TEXELS 6

ivec2 instance_texel(int instance, int texel)
{
  return ivec2((instance % INSTANCES_PER_ROW) * INSTANCE_TEXELS + texel, instance / INSTANCES_PER_ROW);
}

mat4 instance_world(sampler2D instances_tx, int instance)
{
  vec4 x = texelFetch(instances_tx, instance_texel(instance, 0), 0);
  vec4 y = texelFetch(instances_tx, instance_texel(instance, 1), 0);
  vec4 z = texelFetch(instances_tx, instance_texel(instance, 2), 0);
  return transpose(mat4(x, y, z, vec4(0.0, 0.0, 0.0, 1.0)));
}

#endif
