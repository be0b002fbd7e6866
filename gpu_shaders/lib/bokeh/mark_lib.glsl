// The fate of a source (culled, masked, splatted, ...) as the debug view shows it: numbers of its
// colours.
#ifndef MARK_LIB_GLSL
#define MARK_LIB_GLSL
#include "lib/bokeh/source_lib.glsl"

#define FATE_SHARP 0
#define FATE_OUTSIDE 1
#define FATE_HIDDEN 2
#define FATE_VISIBLE 3
#define FATE_FREE 4
#define FATE_MASKED 5
#define FATE_IN_SPLAT 6

// `kind`: of its tile; `state`: what the tests have found.
int fate_of(float kind, float state)
{
  if (kind == SOURCE_DROP) {
    return (state == STATE_OUTSIDE) ? FATE_OUTSIDE : FATE_HIDDEN;
  }
  if (kind == SOURCE_UNMASKED) {
    return (state == STATE_FREE) ? FATE_FREE : FATE_VISIBLE;
  }
  return (kind == SOURCE_MASKED) ? FATE_MASKED : FATE_IN_SPLAT;
}

#endif
