"""Glass: its surface, what it refracts and what it mirrors, each as far away as it appears."""
