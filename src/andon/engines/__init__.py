"""Two engines, one truth: the same four verbs, in float64 by rays or in WGSL by maps.

============ ============================================= =================================
engine       what it is                                    where it is used
============ ============================================= =================================
reference    NumPy in float64, Embree's rays               oracle of the tests; no adapter
gpu          WGSL through wgpu; software Vulkan included   everything else
============ ============================================= =================================

Verbs, in the order of light: ``see`` → ``illuminate`` → ``compose`` → ``encode``; what passes
between them belongs to the engine (arrays here, textures there), what comes out of ``read`` are
the quantities of `andon.quantities`.
"""
