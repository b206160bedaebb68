"""Where the picture steps from the object to what is behind it, to a fraction of a pixel."""
