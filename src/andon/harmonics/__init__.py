"""Spherical harmonics, bands 0 to 4."""
