// Front-to-back depth peeling: the depth test leaves the nearest fragment beyond the layer that was peeled before.
// Invariant: layer i is the fragment with depth rank i of each pixel. Of fragments with equal depth one is kept.
// Source: Everitt 2001, as in kplus_2015 §2.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

uniform uint iteration;

void main() {
    if (rejected()) discard;
#if STOPS
    if (1.0 - texelFetch(image, ivec2(gl_FragCoord.xy), 0).a >= STOP_OPACITY) discard;
#endif
    if (iteration > 0u && gl_FragCoord.z <= texelFetch(layer_depth, ivec2(gl_FragCoord.xy), 0).x) discard;
    out_layer = premultiplied(incoming().y);
}
