"""A scene as Radiance is told it."""
