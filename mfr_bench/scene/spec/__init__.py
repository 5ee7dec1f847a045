"""What a kind of scene is declared with: types of values, the class of a kind, where primitives go, expected counts."""
