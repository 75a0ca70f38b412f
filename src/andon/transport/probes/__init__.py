"""Probes: light captured at places, and mixed between them for whatever moves there.

What
    A probe holds the light that arrives at its place from all directions, as spherical harmonics
    of luminance. Probes are joined to tetrahedra (`cells`); at a point the four around it are mixed
    with its barycentric coordinates (`locate`), and the mix gives the irradiance of a surface.
Why tetrahedra
    Light changes quickly near doors, windows and coloured walls, and hardly at all elsewhere. Free
    probes stand where it changes; the Delaunay tetrahedra between them make it linear within each
    cell and continuous across faces, for four reads, wherever they stand.

==========================  ========  =========  ==================================================
way to mix                  reads     probes     what is wrong with it
==========================  ========  =========  ==================================================
lattice, trilinear          8         everywhere most of them where nothing changes
inverse distance, all       n         free       costs grow with n; flat spots around each probe
radial functions            n         free       a system of n equations; overshoots below zero
**tetrahedra**              4         free       the cell must be found: 1–3 steps from a grid
==========================  ========  =========  ==================================================

Outside the hull
    The light of the hull's *closest point*. A projection onto a convex set is unique, continuous,
    and moves by no more than the point does. Cupisz extrudes the hull's triangles along averaged
    normals and solves a cubic for the one that a point is in: smoother across edges, but prisms
    overlap where normals bend inwards, and roots have to be told apart near flat sides.
    A walk over facets finds the closest point (`lookup_facets`).
Any set of probes
    Lattices are cospherical, maps of panoramas flat, corridors straight: `delaunay` joins them
    without slivers or cracks, `cells` falls back to triangles, pieces of a line, one probe. What
    cannot be joined is refused when it is built; a lookup never raises.
Zones
    Tetrahedra know no walls. A volume may have zones, boxes with probes and cells of their own;
    and `visibility` takes away what a probe cannot have seen.
Two engines
    `lookup` in NumPy is the reference, `lookup_numba` the same for one point after the other,
    `cells.wgsl` and `hull.wgsl` on the GPU; `vectors` publishes what all must answer.

Sources: the probes paper, sections 3 and 4; Cupisz 2012 (light probes in tetrahedra); Ericson 2004
(closest points); Edelsbrunner 1990 (walks end); Barber, Dobkin & Huhdanpaa 1996 (Qhull).
"""
