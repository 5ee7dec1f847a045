// Reconstructs the absorbance in front of a depth from MOMENTS power moments of the absorbance over depth. Among all
// measures with these moments, one has a support point at the depth itself, and it bounds all others: the weight of its
// support points before the depth is the least that can lie there, and with the weight at the depth added it is the
// most. As in the paper, SHARE of that weight is added. The other support points are the roots of the kernel K(x, z) =
// v(x) B^-1 v(z), with B the Hankel matrix of the moments and v(x) the powers of x; the weight of a support point x is
// 1 / K(x, x).
// Source: Muenstermann et al. 2018, §3.2; kernel and weights: Christoffel function, Krein and Nudelman 1977.
#include "methods/moments/roots.glsl"

const float SHARE = 0.25;
const float LEAST_PIVOT = 1e-9;

// The depth, and the other support points.
#if MOMENTS == 4
#define SUPPORT vec3
#else
#define SUPPORT vec4
#endif

// Factors of B = L D L^T: L, which has a unit diagonal, and D, of which the first element is 1.
float l10, l20, l21, d1, d2;
#if MOMENTS == 6
float l30, l31, l32, d3;
#endif

// Moves the moments by `bias` towards those of a spread-out measure, so that B stays positive definite in float32. The
// values are those of the paper for single precision.
void biased(inout float moment[MOMENTS + 1]) {
#if MOMENTS == 4
    const float SPREAD[5] = float[](1.0, 0.0, 0.375, 0.0, 0.375);
    const float bias = BIAS;
#else
    const float SPREAD[7] = float[](1.0, 0.0, 0.48, 0.0, 0.451, 0.0, 0.45);
    const float bias = BIAS_6;
#endif
    for (int i = 0; i <= MOMENTS; ++i) moment[i] = mix(moment[i], SPREAD[i], bias);
}

void factorize(float moment[MOMENTS + 1]) {
    l10 = moment[1];
    l20 = moment[2];
    d1 = max(moment[2] - l10 * l10, LEAST_PIVOT);
    l21 = (moment[3] - l20 * l10) / d1;
    d2 = max(moment[4] - l20 * l20 - l21 * l21 * d1, LEAST_PIVOT);
#if MOMENTS == 6
    l30 = moment[3];
    l31 = (moment[4] - l30 * l10) / d1;
    l32 = (moment[5] - l30 * l20 - l31 * l21 * d1) / d2;
    d3 = max(moment[6] - l30 * l30 - l31 * l31 * d1 - l32 * l32 * d2, LEAST_PIVOT);
#endif
}

// 1 / K(x, x) of each point, by L y = v(x).
SUPPORT weights_at(SUPPORT x) {
    SUPPORT y1 = x - l10, y2 = x * x - l20 - l21 * y1;
    SUPPORT kernel = 1.0 + y1 * y1 / d1 + y2 * y2 / d2;
#if MOMENTS == 6
    SUPPORT y3 = x * x * x - l30 - l31 * y1 - l32 * y2;
    kernel += y3 * y3 / d3;
#endif
    return 1.0 / kernel;
}

// Solves B c = v(z): c are the coefficients of K(x, z) as a polynomial in x.
SUPPORT kernel_at(float z) {
    float y1 = z - l10, y2 = z * z - l20 - l21 * y1;
#if MOMENTS == 6
    float c3 = (z * z * z - l30 - l31 * y1 - l32 * y2) / d3;
    float c2 = y2 / d2 - l32 * c3;
    float c1 = y1 / d1 - l21 * c2 - l31 * c3;
    return vec4(1.0 - l10 * c1 - l20 * c2 - l30 * c3, c1, c2, c3);
#else
    float c2 = y2 / d2, c1 = y1 / d1 - l21 * c2;
    return vec3(1.0 - l10 * c1 - l20 * c2, c1, c2);
#endif
}

// `moment` are the moments of the absorbance over depth; the 0th is the total absorbance.
float absorbance_before(float z, float moment[MOMENTS + 1]) {
    float total = moment[0];
    for (int i = 0; i <= MOMENTS; ++i) moment[i] /= total;
    biased(moment);
    factorize(moment);
#if MOMENTS == 4
    SUPPORT support = vec3(z, quadratic_roots(kernel_at(z)));
    vec2 before = vec2(lessThan(support.yz, vec2(z)));
#else
    SUPPORT support = vec4(z, cubic_roots(kernel_at(z)));
    vec3 before = vec3(lessThan(support.yzw, vec3(z)));
#endif
    return total * clamp(dot(weights_at(support), SUPPORT(SHARE, before)), 0.0, 1.0);
}
