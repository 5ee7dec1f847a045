// Tells the listing of tiles which pixels have fragments, by their counter.
#define FETCH_COUNT(p) counter[p]
