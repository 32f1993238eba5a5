"""A third learning rule, as somebody would add it: settings and rule."""
