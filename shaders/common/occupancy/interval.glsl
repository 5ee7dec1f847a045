// Divides the depth range of a pixel into OCCUPANCY equal intervals. The last interval includes the far bound; a range
// of length zero is one interval.
float bounds_near(vec2 bounds) {
    return -bounds.x;
}

uint interval_of(float z, vec2 bounds) {
    float range = bounds.y - bounds_near(bounds);
    return range > 0.0 ? min(uint((z - bounds_near(bounds)) / range * float(OCCUPANCY)), uint(OCCUPANCY - 1)) : 0u;
}

// Returns a depth beyond which no fragment of the interval lies: it exceeds the exact end by more than all rounding.
float interval_end(uint interval, vec2 bounds) {
    float near = bounds_near(bounds), range = bounds.y - near;
    float end = near + range * (float(interval + 1u) / float(OCCUPANCY));
    return interval + 1u < uint(OCCUPANCY) ? min(end * (1.0 + exp2(-18.0)), bounds.y) : bounds.y;
}
