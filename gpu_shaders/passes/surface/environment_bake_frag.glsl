// Evaluates the nodes of a world in each direction, as an equirectangular image.
// Inputs: what the generated surface_closure() reads: material_buf, image_0_tx, ...; it calls
// environment_sample for the world's images.
// Outputs: scene-linear colour.
// Source: Blender's equirectangular mapping, see lib/surface/environment_lib.glsl.

void main()
{
  world_direction = equirect_to_direction(gl_FragCoord.xy * texel_size);
  out_color = vec4(surface_closure().radiance, 1.0);
}
