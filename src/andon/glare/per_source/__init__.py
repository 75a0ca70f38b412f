"""The veil and the halo of known sources, drawn around each of them.

What
    ``E·(K ⊗ shape)`` in cd/m² for lamps, and for sources found in a picture, of any outline: as
    quads on the GPU whose pixels look their luminance up in tables, as the paper's hardware did.
Why this way
    The veil of a uniform source is a function of one or two coordinates that its outline alone
    decides, so it is made once, exactly, as a table (2 ms for a circle, some 100 ms for others),
    and a frame costs one or two reads per pixel and source whatever the spread function. Distances
    are chords between directions, so all is round on the sphere, in every projection.
Instead of
    the paper's falloff from the outline, up to 23 times off beside a disc of 1° (kept as `bloom`);
    billboards, which are round in pixels and not in angle; a sprite per source, which cannot
    follow a light that changes its size, and is blurred by its magnification.
Sources
    the glare paper; CIE 146:2002 (what is convolved).
"""
