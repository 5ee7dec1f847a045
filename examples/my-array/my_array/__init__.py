"""A method for mfr-bench, declared in method.py; its GLSL is below shaders/."""
