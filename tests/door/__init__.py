"""The guarded door: who comes in, and what a page may send."""
