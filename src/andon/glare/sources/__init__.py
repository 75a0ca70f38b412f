"""Where glare comes from: bright regions of a picture, highlights, lamps of a scene."""
