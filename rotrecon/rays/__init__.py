"""Surfaces fitted along the rays, in the quantity in which the sensor errs."""
