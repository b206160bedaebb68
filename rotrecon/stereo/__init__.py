"""From two or more views of known pose to one frame with depth."""
