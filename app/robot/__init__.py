"""The robot's side of the door: what a controller reads, and frames that it pushes in. Nothing here can confirm."""
