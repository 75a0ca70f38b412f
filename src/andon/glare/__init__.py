"""Glare: what bright things do in the eye that sees them."""
