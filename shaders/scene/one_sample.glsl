// Lets one sample of a fragment pass of those that it covers, so that occlusion queries count fragments. It stands behind
// scene/fragment.glsl in geometry passes without targets whose scene is rasterized into several samples a pixel.
bool rejected_in_samples() {
    gl_SampleMask[0] = gl_SampleMaskIn[0] & -gl_SampleMaskIn[0];
    return rejected();
}

#define rejected rejected_in_samples
