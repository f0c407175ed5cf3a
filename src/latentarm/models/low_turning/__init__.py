"""The low-turning model: homogeneous, with directions that turn little more than the stick does."""
