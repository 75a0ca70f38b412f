"""Depth maps seen from lamps: dual paraboloids for all directions, planes for cones and the sun."""
