"""The CACLA+VAR actor-critic that commands the eye muscles."""
