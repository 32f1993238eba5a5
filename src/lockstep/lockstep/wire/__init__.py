"""What goes over the wire: topics, their names and stamps, and messages as bytes."""
