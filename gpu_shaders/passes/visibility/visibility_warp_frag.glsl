// Visibility of a source from a place on the lens, by a ray through the peeled layers.
// Inputs: v_lens, v_source (see visibility_warp_vert); sources_tx, states_tx, layers_tx, opacity_tx;
// visibility_buf.
// Outputs: share of the light that passes.
// Source: methods 11 (J20 section 4.4).
#include "lib/bokeh/source_lib.glsl"

void main()
{
  ivec2 texel = list_texel(v_source);
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
  float nearest = texelFetch(states_tx, texel, 0).x;
  out_mask = visibility_cast(layers_tx,
                             opacity_tx,
                             source.place,
                             source.depth,
                             source.limit,
                             nearest,
                             v_lens * source_reach(visibility_buf),
                             visibility_buf.layers.x > 0.5);
}
