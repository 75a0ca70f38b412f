"""Sources of glare found in pictures: blobs of bright pixels, their light and their outlines."""
