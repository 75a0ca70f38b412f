"""Tasks: what is done once, by whom, and what of it is done already."""
