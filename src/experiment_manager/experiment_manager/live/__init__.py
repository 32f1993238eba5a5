"""A run in Lichtblick or Foxglove: a WebSocket server, what it shows, and its layout."""
