"""What is seen through glass, and in it: pictures, the frame, the scene, and what is all around."""
