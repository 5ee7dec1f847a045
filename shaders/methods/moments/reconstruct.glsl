// Reconstructs the absorbance in front of a depth from MOMENTS power moments of the absorbance over depth. Among all
// measures with these moments, one has a support point at the depth itself, and it bounds all others: the weight of its
// support points before the depth is the least that can lie there, and with the weight at the depth added it is the
// most. As in the paper, SHARE of that weight is added. The other support points are the roots of the kernel K(x, z) =
// v(x) B^-1 v(z), with B the Hankel matrix of the moments and v(x) the powers of x; the weight of a support point x is
// 1 / K(x, x).
// Source: Muenstermann et al. 2018, §3.2; kernel and weights: Christoffel function, Krein and Nudelman 1977.
#include "methods/moments/roots.glsl"

const int SIDE = MOMENTS / 2 + 1;
const float SHARE = 0.25;
const float LEAST_PIVOT = 1e-9;

// Factors of B = L D L^T: L, which has a unit diagonal, and D.
float lower[SIDE * SIDE], pivot[SIDE];

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
    for (int j = 0; j < SIDE; ++j) {
        for (int i = j; i < SIDE; ++i) {
            float entry = moment[i + j];
            for (int k = 0; k < j; ++k) entry -= lower[i * SIDE + k] * lower[j * SIDE + k] * pivot[k];
            if (i == j) pivot[j] = max(entry, LEAST_PIVOT);
            else lower[i * SIDE + j] = entry / pivot[j];
        }
    }
}

// Solves L y = v(x).
float[SIDE] forward(float x) {
    float y[SIDE], power = 1.0;
    for (int i = 0; i < SIDE; ++i) {
        y[i] = power;
        for (int k = 0; k < i; ++k) y[i] -= lower[i * SIDE + k] * y[k];
        power *= x;
    }
    return y;
}

float weight_at(float x) {
    float y[SIDE] = forward(x), kernel = 0.0;
    for (int i = 0; i < SIDE; ++i) kernel += y[i] * y[i] / pivot[i];
    return 1.0 / kernel;
}

// Solves B c = v(z): c are the coefficients of K(x, z) as a polynomial in x.
float[SIDE] kernel_at(float z) {
    float c[SIDE] = forward(z);
    for (int i = 0; i < SIDE; ++i) c[i] /= pivot[i];
    for (int i = SIDE - 1; i >= 0; --i)
        for (int k = i + 1; k < SIDE; ++k) c[i] -= lower[k * SIDE + i] * c[k];
    return c;
}

// `moment` are the moments of the absorbance over depth; the 0th is the total absorbance.
float absorbance_before(float z, float moment[MOMENTS + 1]) {
    float total = moment[0];
    for (int i = 0; i <= MOMENTS; ++i) moment[i] /= total;
    biased(moment);
    factorize(moment);
    float c[SIDE] = kernel_at(z);
#if MOMENTS == 4
    vec2 support = quadratic_roots(vec3(c[0], c[1], c[2]));
#else
    vec3 support = cubic_roots(vec4(c[0], c[1], c[2], c[3]));
#endif
    float part = SHARE * weight_at(z);
    for (int i = 0; i < MOMENTS / 2; ++i)
        if (support[i] < z) part += weight_at(support[i]);
    return total * clamp(part, 0.0, 1.0);
}
