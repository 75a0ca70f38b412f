"""Captured light × (dimming·E0 + ΔE)/E0: the photograph under its new light.

What
    ``L_c = luminance_per_unit · g⁻¹(RGB_c) · (dimming_c·E0_c + ΔE_c)/E0_c`` on the real surface;
    ``L_c = ρ_c/π · (dimming_c·E0_c + ΔE_c)`` on virtual objects; lamps with a visible radius are
    drawn as discs of their own luminance where nothing is nearer.
Why a ratio
    The captured pixel carries the texture. Its reflectance cancels: no albedo has to be guessed,
    only the light E0 that the photograph was taken under, which is always stated.

==================  ==============================  =====================================
how to relight      needs                           fails where
==================  ==============================  =====================================
**ratio of E**      geometry, E0                    the photograph is black or clipped
reflectance × E     geometry, an albedo estimate    the estimate takes shadow for paint
learned             a network                       no unit survives
==================  ==============================  =====================================

Where a surface was measured (`SurfaceCurve`: f, what the camera delivers of it in E lux) the ratio
is one of its light, not of camera values: ``f_c(f_c⁻¹(RGB_c) · (dimming_c·E0_c + ΔE_c)/E0_c)``; f
undoes what a camera's own response g leaves (tone, black level, haze). Where E0 is too weak for the
photograph to tell a reflectance, a stated picture of ρ takes the added light (`per_lux`).

Holes keep their captured light (dimmed, since dimming needs no geometry): nothing is guessed.

Source: the relighting paper, sections 2.1 and figure 1
(照度-RGB モデル: illuminance–RGB model).
"""
