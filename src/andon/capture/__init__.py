"""Sensor values → linear light: a still photograph, its response, its lens, its view.

The response g is undone here and applied again only by the display, so everything between is
linear. A picture is undistorted at once: stages see ideal views and nothing else.
"""
