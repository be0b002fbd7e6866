// How the discs of highlights are drawn.
struct SplatParams {
  vec4 opening;         // x: anamorphic ratio; y: side of the square that blurs as the pixel filter
                        // does, px; z: how far the opening reaches in units of its radius; w: regions
                        // of the lens along a side that highlights are looked for from
};
