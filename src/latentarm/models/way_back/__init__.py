"""A way back to what was demonstrated, for every decoder: see `runtime.py`."""
