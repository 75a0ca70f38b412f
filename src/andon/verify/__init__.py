"""Accuracy, measured on the reader's machine: ``andon verify``.

Every row holds one of our results against something that does not share its code: a closed form,
Embree's rays, Radiance. A row whose truth is not installed says so and counts as not shown.
"""
