// What a fragment takes from the light, as an exponent: transmittance is exp(-absorbance), and absorbances add up.
// An opaque fragment's is infinite; it is clamped to 10, a transmittance of 4.5e-5 (Muenstermann et al. 2018).
const float MOST_ABSORBANCE = 10.0;

float absorbance_of(float alpha) {
    return min(-log(1.0 - alpha), MOST_ABSORBANCE);
}

// Window depth on [-1, 1], where powers stay in bounds. The paper takes the logarithm of a distance, which a
// perspective asks for; here depth is linear.
float moment_depth(float depth) {
    return 2.0 * depth - 1.0;
}
