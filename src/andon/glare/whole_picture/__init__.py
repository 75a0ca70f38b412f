"""The veil of a whole picture: all its light, scattered in angle space."""
