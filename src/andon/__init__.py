"""Andon: light for mixed reality."""
