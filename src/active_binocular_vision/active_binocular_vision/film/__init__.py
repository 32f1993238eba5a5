"""A film of what the eyes saw: before, during and after learning."""
