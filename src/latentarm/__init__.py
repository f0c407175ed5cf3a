"""Steer a high-DoF assistive robot arm with a low-DoF input, by latent actions.

``import latentarm as la`` offers what a program of your own needs. Each name is imported when it is first
used, so the import itself loads neither torch nor MuJoCo. ``__init__.pyi`` is the list, and type checkers
read it too.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
