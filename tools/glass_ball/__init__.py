"""The parts of examples/glass, drawn: a pattern to look at through glass, and a label on it."""
