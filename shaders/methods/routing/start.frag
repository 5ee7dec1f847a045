// Stencil routing, start: from a stencil of 1 everywhere, instance i increments samples i and above, so that
// sample s starts at s + 2. Each fragment then decrements all samples and enters the one that stands at 2.
// Invariant: sample s takes the fragment that arrives as number s; clamped at 0, it takes none after.
// Source: Myers and Bavoil 2007; Bavoil and Myers 2008.
flat in uint instance;

void main() {
    gl_SampleMask[0] = -1 << instance;
}
