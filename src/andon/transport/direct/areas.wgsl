// Projected solid angles of area lamps in sr, horizon included: E = luminance · factor. The same
// functions as andon.lamps.form_factors, whose docstring has the method and its sources; here
// branch-free, in float32, and with polynomials for what a software rasteriser is slow at and a
// specification vague about (WGSL grants acos an error of 7e-5 and atan2 4096 ulp).
//
// `reach` and vertices are relative to the receiver. A difference of two *directions* is wrong by
// 6e-8, as much as a lamp of r/d = 0.01 at the horizon gives in all; a difference of two *offsets*
// only by 6e-8 of its own size. So outlines are closed in space, offset by offset.

//!import andon/transport/direct/areas/rounds.wgsl
//!import andon/transport/direct/areas/edges.wgsl
//!import andon/transport/direct/areas/tubes.wgsl
