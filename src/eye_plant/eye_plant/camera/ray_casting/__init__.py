"""Drawing by casting rays in compiled loops, which needs no OpenGL."""
