// Converts opacity to absorbance: the transmittance is exp(-absorbance), so that absorbances of fragments add up. The
// absorbance of an opaque fragment is infinite; it is clamped to 10, a transmittance of 4.5e-5 (Muenstermann et al.
// 2018).
const float MOST_ABSORBANCE = 10.0;

float absorbance_of(float alpha) {
    return min(-log(1.0 - alpha), MOST_ABSORBANCE);
}

// Maps window depth to [-1, 1], where powers stay bounded. The paper takes the logarithm of a distance, as suits a
// perspective; here depth is linear.
float moment_depth(float depth) {
    return 2.0 * depth - 1.0;
}
