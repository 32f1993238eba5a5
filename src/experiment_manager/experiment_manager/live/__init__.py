"""A run or a bag in Lichtblick or Foxglove: a WebSocket server, what it shows, and its layout."""
