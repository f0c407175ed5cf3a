"""What the studies of `latentarm reproduce` have in common."""
