"""From luminance to what a screen is sent: exposure, tone, the camera's response, 8 bits.

What
    ``code = round(255·g(tone(exposure·L)))``: L in cd/m², g the response of the camera.
Why the camera's own response
    A video see-through display repeats the camera. With g, and by default the exposure at which
    unchanged light returns with the bytes it came with, a frame without lamps *is* the photograph,
    byte for byte; whatever differs was put there by light. Pictures are linear up to here.

=====================  ===========================================  ==========================
tone                   above white                                  identity without lamps
=====================  ===========================================  ==========================
**none**               clips, as the camera would                   everywhere
reinhard (shoulder)    bends towards white, per channel             below 0.6 of white
global operators       compress the whole range                     nowhere
fusion                 simulated exposures, fused by parts          nowhere
=====================  ===========================================  ==========================

Optical see-through (`ost`) adds light to what is seen instead: codes of its own, and a simulated
view that is shown by the way above.

Sources: IEC 61966-2-1 (sRGB); Reinhard et al. 2002, equation 3, for the shoulder.
"""
