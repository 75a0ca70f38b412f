"""The mannequin of examples/basic: its bones, its skin, its walk."""
