"""Learn 2-D latent actions from demonstrations in memory and ask what each direction of the stick does."""

import numpy as np

import latentarm as la

task = la.TableTop()
demonstrations = task.demonstrate(12, np.random.default_rng(0))

model = la.CVAE(latent_dim=2, seeds=2, epochs=3, state_noise_rad=0.01)
model.fit(demonstrations)
decoder = model.decoder(seed=0)

state = task.robot.home
here = task.robot.chain.forward(state).position
for name, u in {"right": [1, 0], "left": [-1, 0], "up": [0, 1], "down": [0, -1]}.items():
    action = decoder.decode(np.array(u, dtype=float), state)
    there = task.robot.chain.forward(state + 0.5 * action).position
    print(f"{name:>5} held for half a second moves the tool by {np.round(100 * (there - here), 1)} cm")
