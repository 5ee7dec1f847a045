// Computes the weight of a fragment in weighted blended OIT by one of the paper's equations. Eq. 7 to 9 expect a
// distance from the eye and are fitted to 0.1 .. 500; window depth, which is linear in an orthographic view, is mapped
// to that range.
// Source: McGuire and Bavoil 2013, Eq. 7-10.
const float NEAR = 0.1, FAR = 500.0;
const float LEAST_WEIGHT = 1e-2, MOST_WEIGHT = 3e3;

float falling(float rise, float distance_term) {
    return clamp(rise / (1e-5 + distance_term), LEAST_WEIGHT, MOST_WEIGHT);
}

float squared(float x) {
    return x * x;
}

float cubed(float x) {
    return x * x * x;
}

float weight(float depth, float alpha) {
    float z = mix(NEAR, FAR, depth);
#if WEIGHT_EQ7
    return alpha * falling(10.0, squared(z / 5.0) + squared(cubed(z / 200.0)));
#elif WEIGHT_EQ8
    return alpha * falling(10.0, cubed(z / 10.0) + squared(cubed(z / 200.0)));
#elif WEIGHT_EQ9
    return alpha * falling(0.03, squared(squared(z / 200.0)));
#else
    return alpha * max(LEAST_WEIGHT, MOST_WEIGHT * cubed(1.0 - depth));
#endif
}
