"""What stands about the arm: things, food and grains, as plain data; no physics engine."""
