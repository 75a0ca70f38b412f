"""From luminance to what a screen is sent: exposure, tone, the camera's response, 8 bits.

Pictures are linear up to here. A video see-through display repeats the camera: the same response,
and by default the exposure at which unchanged light returns with the bytes it came with.
"""
