"""Ways to steer an arm: latent actions, and today's mode-switched end-effector control."""
