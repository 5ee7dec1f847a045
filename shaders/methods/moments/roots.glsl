// Computes the real roots of the polynomials that the reconstruction needs; all of their roots are real. One root may
// lie at infinity, if the leading coefficient vanishes; an overflowing root is limited to FURTHEST, where its weight is
// negligible.
const float FURTHEST = 1e4;

float bounded(float numerator, float denominator) {
    return abs(numerator) < FURTHEST * abs(denominator) ? numerator / denominator
                                                        : FURTHEST * sign(numerator) * (denominator < 0.0 ? -1.0 : 1.0);
}

// Roots of c[0] + c[1] x + c[2] x^2 without cancellation: the sum of the roots gives the one of greater magnitude,
// their product the other.
vec2 quadratic_roots(vec3 c) {
    float q = -0.5 * (c[1] + (c[1] < 0.0 ? -1.0 : 1.0) * sqrt(max(0.0, c[1] * c[1] - 4.0 * c[0] * c[2])));
    return vec2(bounded(q, c[2]), bounded(c[0], q));
}

// A root near 0 of u^3 c[0] + u^2 c[1] + u c[2] + c[3]: the reciprocal of a root of the cubic, or 0 for a root at
// infinity. Laguerre's method converges to a root from any start if all roots are real.
float reciprocal_root(vec4 c) {
    float u = 0.0;
    for (int i = 0; i < 6; ++i) {
        float value = ((c[0] * u + c[1]) * u + c[2]) * u + c[3];
        float slope = (3.0 * c[0] * u + 2.0 * c[1]) * u + c[2];
        float curve = 6.0 * c[0] * u + 2.0 * c[1];
        float spread = sqrt(max(0.0, 4.0 * slope * slope - 6.0 * value * curve));
        float down = slope + (slope < 0.0 ? -spread : spread);
        if (value == 0.0 || down == 0.0) break;
        u -= 3.0 * value / down;
    }
    return u;
}

// Roots of c[0] + c[1] x + c[2] x^2 + c[3] x^3: one root, and the roots of the quadratic that is left after dividing it
// out. The division starts at the constant term, which is stable for a root of great magnitude.
vec3 cubic_roots(vec4 c) {
    float u = reciprocal_root(c);
    float middle = c[1] + c[0] * u;
    return vec3(bounded(1.0, u), quadratic_roots(vec3(c[0], middle, c[2] + middle * u)));
}
