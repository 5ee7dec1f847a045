// Puts the coverage mask of a fragment into its payload. It stands behind common/payload.glsl, or what follows it, in
// geometry passes whose scene is rasterized into several samples a pixel. The shader runs once for each fragment, with
// the depth of the middle of the pixel, whichever samples are covered.
// The host's word has all bits of a mask set; those of samples that the fragment does not cover are taken out.
PAYLOAD payload_of_covered(uint word) {
    return payload_from(word & (uint(gl_SampleMaskIn[0]) | ~((1u << MASK_BITS) - 1u)));
}

#undef payload_from
#define payload_from payload_of_covered
