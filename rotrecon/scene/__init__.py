"""The scene folder: read, validated, written, and made of foreign recordings."""
