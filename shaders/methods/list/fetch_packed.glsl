// Reads the fragments of a list of 64-bit records (inverted depth, link), in the order of its links.
#include "common/helper.glsl"

uint fetch_at;

void fetch_begin(uint p) {
    fetch_at = p;
}

bool fetch_next(out uvec2 fragment) {
    if (IS_HELPER) return false;
    uvec2 record = unpackUint2x32(records[fetch_at]);
    if (record == uvec2(0u)) return false;
    fetch_at = record.x;
    fragment = uvec2(~record.y, payload[fetch_at - pixels]);
    return true;
}
