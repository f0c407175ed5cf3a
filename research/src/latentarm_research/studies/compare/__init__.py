"""`latentarm compare`: every model on recorded demonstrations, side by side."""
