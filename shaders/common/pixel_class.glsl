// Classes of pixels by their number of fragments, represented as depths: a pixel of class i has at most 8 * 2^i
// fragments, and a pixel without fragments has NO_CLASS.
#define CLASS_DEPTH(index) (float(index) / 16.0)
#define NO_CLASS 16
