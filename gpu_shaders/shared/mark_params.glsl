// How the marks of the debug view are drawn.
struct MarkParams {
  vec4 size;            // x: half the side of a dot, px; y: half the width of a line, px; z: opacity of
                        // rings; w: anamorphic ratio
  vec4 source;          // x: radius up to which a source is too sharp to be splatted, px; yzw unused
  vec4 colors[8];       // rgb: by the fate of a source, see mark_lib
};
