"""The parts of a declared kind of scene: types of values, the class of a kind, where primitives go, expected counts."""
