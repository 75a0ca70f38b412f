"""Defocus: each layer of the glass blurred by how far it is from where the eye is focused."""
