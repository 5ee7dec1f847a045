// Whether the compositing of a pixel ends: what is still behind can change no channel by more than 1 - STOP_OPACITY.
bool enough(vec4 colour) {
    return STOP_OPACITY < 1.0 && colour.a >= STOP_OPACITY;
}
