"""Two MuJoCo eyes, moved by twelve muscles, that look at a textured plane."""
