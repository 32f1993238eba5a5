"""The published rule, CACLA+VAR: a linear critic, and an actor that copies what did better."""
