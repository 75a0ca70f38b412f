"""The GPU as a tool: device, WGSL modules, passes, textures, timers. Knows nothing of light.

WGSL through `wgpu` runs on Vulkan, Metal and D3D12, and on software Vulkan (Mesa's lavapipe),
which is what most servers have. What that software rasteriser rewards shaped this folder
(measured on two cores, 1280×720): a full-screen fragment pass with an empty body costs 2 ms, each
texture read of it 3 ms whatever the format, the same work as a compute pass over storage buffers
about seven times as much. Hence few, full passes over few, wide textures.
"""
