"""Things that are no body of revolution, before a camera, and what an operator might take for one."""
