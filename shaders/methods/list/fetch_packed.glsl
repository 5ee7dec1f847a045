// Reads the fragments of a list of 64-bit records (link, inverted depth) in the order of its links.
// Buffers: reads records, payload.
#include "common/helper.glsl"
#include "common/payload.glsl"

uint fetch_at;

void fetch_begin(uint p) {
    fetch_at = p;
}

bool fetch_next(out FRAGMENT fragment) {
    if (IS_HELPER) return false;
    uvec2 record = records_at(fetch_at);
    if (record == uvec2(0u)) return false;
    fetch_at = record.x;
    fragment = fragment_of(~record.y, payload_at(fetch_at - pixels));
    return true;
}
