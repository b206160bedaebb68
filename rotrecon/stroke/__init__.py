"""The axis an operator would have drawn, and directions that are held."""
