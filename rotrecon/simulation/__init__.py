"""Scenes whose truth is known: analytic bodies rendered, and the errors of a stereo camera."""
