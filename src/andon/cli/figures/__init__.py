"""Figures 4 to 8 of the glare paper, drawn from inputs of our own: ``andon glare figures``."""
