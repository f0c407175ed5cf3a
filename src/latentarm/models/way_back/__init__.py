"""A way back to the demonstrations, for every decoder: see `runtime.py`."""
