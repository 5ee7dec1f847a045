// Classes of pixels by their number of fragments, held as depth: class i has at most 8 * 2^i, an empty pixel none.
#define CLASS_DEPTH(index) (float(index) / 16.0)
#define NO_CLASS 16
