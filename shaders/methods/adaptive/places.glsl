// Names the places of a pixel in the framebuffer, of which each holds a fragment: EACH_PLACE(DO) expands to DO(place) for
// each of LAYERS, from the nearest to the furthest, which is LAST_PLACE. The including file defines EIGHTH_PLACE: with
// eight layers the image has no room beside them, and a pass that draws it reads that place from a texture.
#define PLACES2(DO) DO(out_kept_0) DO(out_kept_1)
#define PLACES4(DO) PLACES2(DO) DO(out_kept_2) DO(out_kept_3)
#define PLACES6(DO) PLACES4(DO) DO(out_kept_4) DO(out_kept_5)
#define PLACES7(DO) PLACES6(DO) DO(out_kept_6)

#if LAYERS == 2
#define EACH_PLACE PLACES2
#define LAST_PLACE out_kept_1
#elif LAYERS == 4
#define EACH_PLACE PLACES4
#define LAST_PLACE out_kept_3
#elif LAYERS == 6
#define EACH_PLACE PLACES6
#define LAST_PLACE out_kept_5
#elif LAYERS == 7
#define EACH_PLACE PLACES7
#define LAST_PLACE out_kept_6
#else
#define EACH_PLACE(DO) PLACES7(DO) DO(EIGHTH_PLACE)
#define LAST_PLACE EIGHTH_PLACE
#endif
