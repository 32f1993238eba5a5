"""The ages at which a run is examined."""

BIRTH, BEFORE, END = "birth", "before", "end"
AGES = (BIRTH, BEFORE, END)
