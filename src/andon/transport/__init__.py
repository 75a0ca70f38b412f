"""How light gets from lamps to surfaces: direct now; baked and probes stand beside it."""
