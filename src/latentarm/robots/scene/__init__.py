"""Things, food and grains about the arm, as plain data; no physics engine."""
