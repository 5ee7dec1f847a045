// The mark in the depth of the last place of a pixel that had more fragments than places.
#define OVERFULL 0x80000000u
