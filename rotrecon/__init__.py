"""Measuring objects of revolution in front of a robot arm from a camera frame with depth."""
