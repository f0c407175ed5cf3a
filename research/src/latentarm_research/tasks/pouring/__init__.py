"""The tasks of the paper's third simulation (section 8.3): Plane, Pour, and Reach & Pour."""
