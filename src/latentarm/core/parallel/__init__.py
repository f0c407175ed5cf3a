"""Independent pieces of work, side by side on the cores of one machine or of many."""
