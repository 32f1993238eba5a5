"""Drawing by MuJoCo's own renderer, which needs OpenGL."""
