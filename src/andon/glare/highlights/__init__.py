"""Lamps mirrored in virtual metal and water.

What
    Luminance in cd/m² that smooth virtual surfaces send to the eye from every lamp, shadowed as
    its diffuse light is.
Models
    ``cook-torrance`` (GGX, Smith's height-correlated masking, Schlick's Fresnel term),
    ``anisotropic`` (the same with two roughnesses), ``phong`` (the glare paper's I·I_s·cosⁿα,
    normalised), and water (the same as the first, exact Fresnel term, rippled).
Area lamps
    The lobe is integrated over the lamp's outline in closed form (`lobes`): a smooth metal shows
    the lamp's sharp image of reflectance × luminance, a rough one a spot of the same light. A
    representative point (Karis 2013) would be one evaluation, but loses either the image or the
    energy; linearly transformed cosines (Heitz 2016) need fitted tables and have no anisotropy.
Rest
    Sky, hemisphere and E0 are mirrored as wide light: their luminance in the mirror's direction,
    or E/π, times the surface's albedo for its direction. Nothing else of the scene is mirrored:
    neither things nor the photograph.
Gate
    A highlight is light of the picture like any other: it has halo and needles where it is 40
    times the ambient level or more (`andon.glare.sources.live`), and is white below.

Sources: Cook and Torrance 1982; Walter et al. 2007; Heitz 2014; Schlick 1994; the glare paper,
sections on metal and water.
"""
