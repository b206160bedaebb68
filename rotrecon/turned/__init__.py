"""Solids of revolution with any profile, and the parts they consist of."""
