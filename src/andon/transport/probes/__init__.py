"""Light captured at places and mixed between them."""
