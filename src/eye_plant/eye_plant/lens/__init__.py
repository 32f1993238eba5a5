"""The eyes' lenses and pupils: what they do to focus, and what moves them."""
