"""The one guarded door: who may come in, what a page may send, and the only way to viser."""
