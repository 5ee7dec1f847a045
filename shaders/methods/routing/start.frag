// Initializes the stencil for routing: all samples start at 1, and instance i increments samples i and above, so that
// sample s ends at s + 2. Later each fragment decrements all samples and is written to the one whose stencil is 2.
// Invariant: sample s takes the fragment that arrives as number s; after that its stencil is clamped at 0 and it takes
// no other.
// Source: Myers and Bavoil 2007; Bavoil and Myers 2008.
flat in uint instance;

void main() {
    gl_SampleMask[0] = -1 << instance;
}
