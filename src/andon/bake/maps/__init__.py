"""Illuminance maps of a scene, made once."""
