// Gives each fragment that is shaded SHADING arithmetic steps, and leaves its colour as it is. It stands behind
// common/payload.glsl in geometry passes, for scenes whose key `shading` is above 0: whatever takes the payload of an
// incoming fragment pays, passes that need its depth alone do not.
// A step is one multiplication and one addition that wait for the step before: x -> 1.5 - x * x. From a depth in
// [0, 1] it stays between -0.75 and 1.5, so the comparison at the end never holds. No compiler can tell, since no
// closed form of the iteration is known to it and its start is the depth of the fragment.
uint shaded(uint word) {
    float x = gl_FragCoord.z;
    for (int i = 0; i < SHADING; ++i) x = 1.5 - x * x;
    return x > 4.0 ? ~word : word;
}

PAYLOAD payload_of_shaded(uint word) {
    return payload_from(shaded(word));
}

#define payload_from payload_of_shaded
