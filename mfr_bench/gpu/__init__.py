"""Everything that touches OpenGL. No other package imports moderngl."""
