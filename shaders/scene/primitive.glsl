// The word that a primitive's fragments take their payload from: RGBA8, or for two_channel, as the host has encoded
// the colour, luminance and hue blend in the lower bytes and alpha in the highest.
#if PAYLOAD_TWO_CHANNEL
in vec4 in_code;
#define PRIMITIVE_WORD packUnorm4x8(in_code)
#else
in vec4 in_rgba;  // straight alpha
#define PRIMITIVE_WORD packUnorm4x8(in_rgba)
#endif
