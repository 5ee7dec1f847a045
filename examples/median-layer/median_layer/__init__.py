"""An effect for mfr-bench, declared in median.py; its GLSL is below shaders/."""
