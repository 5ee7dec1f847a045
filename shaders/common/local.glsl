// Declares the local array of this invocation.
FRAGMENT fragments[LOCAL];
