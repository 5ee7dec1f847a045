// PRIMITIVE_WORD is the word from which the fragments of a primitive take their payload. It is RGBA8, or for the
// payload two_channel the host's encoding: luminance and hue blend in the lower bytes, alpha in the highest.
#if PAYLOAD_TWO_CHANNEL
in vec4 in_code;
#define PRIMITIVE_WORD packUnorm4x8(in_code)
#else
in vec4 in_rgba;  // straight alpha
#define PRIMITIVE_WORD packUnorm4x8(in_rgba)
#endif
