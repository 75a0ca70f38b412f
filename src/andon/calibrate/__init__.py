"""What a scene states, found from pictures: responses, light, lamps, depth.

==================  =====================================================================
of                  from
==================  =====================================================================
a camera            an exposure series: its response
a surface           photographs in known light: its illuminance–RGB curves
E0                  one photograph and its geometry: a picture of illuminance
lamps               a reference photograph: their flux and colour
depth               known lengths, a plane: metres of what is known but for scale and shift
==================  =====================================================================
"""
