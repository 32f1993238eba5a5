"""What the eyes see: the scene, its textures and the renderer."""
