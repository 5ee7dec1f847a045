// Criterion h(f) of the generalized k+-buffer (kplus_2015 §3.2.2, Eq. 2): tells whether fragment a has to leave before
// b.
// Invariant: the criterion is a total order, so that the fragments that stay do not depend on their order of arrival.
// Equal fragments do not displace each other, and an empty slot leaves before any fragment.
#include "common/payload.glsl"

bool worse(FRAGMENT a, FRAGMENT b) {
#if CRITERION_FURTHEST
    return a.x == EMPTY || a.x < b.x || (a.x == b.x && payload_beyond(a, b));
#elif CRITERION_OPAQUE
    uint alpha_a = ordered_alpha(a), alpha_b = ordered_alpha(b);
    if (a.x == EMPTY || alpha_a != alpha_b) return a.x == EMPTY || alpha_a < alpha_b;
#endif
    return a.x > b.x || (a.x == b.x && payload_beyond(a, b));
}

// Tells whether a is worse than b even if other invocations are replacing b by a better fragment, one word at a time.
// Only one word of b is compared, and that word alone has to show whether the slot is empty: an empty slot has all bits
// of its first word set, and of its last, which contains alpha. A white opaque fragment has them as well, so nothing is
// certain of it; no half has all bits set.
bool surely_worse(FRAGMENT a, FRAGMENT b) {
#if CRITERION_FURTHEST
    return b.x != EMPTY && a.x < b.x;
#elif CRITERION_OPAQUE
#if PAYLOAD_RGBA16F
    return b.z != EMPTY && ordered_alpha(a) < ordered_alpha(b);
#else
    return b.y != EMPTY && ordered_alpha(a) < ordered_alpha(b);
#endif
#else
    return a.x > b.x;
#endif
}
