"""Tasks with a fork: marshmallows, the entree and the dessert of the paper's user studies."""
