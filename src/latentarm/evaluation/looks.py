"""Colours, markers and labels of models, conditions and tasks in figures and tables."""

from typing import Final

from latentarm.core.figure_style import Look
from latentarm.models.catalogue import KINDS

_PLAIN: Final = ("#000000", "o", "-")
LOOKS: Final[dict[str, Look]] = {
    "latent": Look("latent actions", "#0072B2", "o", "-"),
    "latent_assist": Look("latent actions + shared autonomy", "#009E73", "D", "-"),
    "end_effector": Look("mode switching", "#7f7f7f", "s", ":"),
    "learned_orientation": Look("position by the stick, orientation learned", "#882255", "P", "--"),
    "two_sticks": Look("two sticks, mode switching", "#56B4E9", "<", ":"),
    "retargeting": Look("retargeting", "#E69F00", "^", "--"),
    "demonstrator": Look("scripted demonstrator", "#000000", "D", "-"),
    "LA": Look("LA", "#7f7f7f", "s", ":"),
    "LA+SA": Look("LA+SA", "#D55E00", "^", "--"),
    "LA+SA+Entropy": Look("LA+SA+Entropy", "#0072B2", "o", "-"),
    "No Align": Look("No Align", "#7f7f7f", "s", ":"),
    "Manual Align": Look("Manual Align", "#bfbfbf", "P", ":"),
    "No Priors": Look("No Priors", "#D55E00", "X", "--"),
    "Proportional": Look("Proportional", "#E69F00", "^", "--"),
    "Reversible": Look("Reversible", "#CC79A7", "v", "--"),
    "Consistent": Look("Consistent", "#56B4E9", "<", "--"),
    "All Priors": Look("All Priors", "#0072B2", "o", "-"),
    "Ideal Align": Look("Ideal Align", "#009E73", "D", "-."),
    "Tool Space": Look("Tool Space", "#000000", "*", "-"),
    "Tool Space, chosen": Look("Tool Space, chosen", "#882255", "^", "-"),
    "plane": Look("Plane", "#009E73", "D", "--"),
    "pour": Look("Pour", "#CC79A7", "v", "-."),
    "reach_and_pour": Look("Reach & Pour", "#000000", "o", "-"),
    "planar_two_cups": Look("planar, 5 joints", "#009E73", "D", "--"),
    "panda_two_cups": Look("Panda, 7 joints", "#CC79A7", "v", "-"),
    "marshmallows": Look("Marshmallows", "#CC79A7", "v", "-."),
    "entree": Look("Entree", "#009E73", "D", "--"),
    "dessert": Look("Dessert", "#000000", "o", "-"),
    "avoid": Look("Avoid", "#D55E00", "X", "--"),
    "apple_pie": Look("Apple pie", "#882255", "^", "-"),
    "moved_marshmallows": Look("Marshmallows, moved", "#CC79A7", "v", ":"),
    "moved_reach_and_pour": Look("Reach & Pour, moved", "#56B4E9", "s", ":"),
}
"""Of conditions and tasks."""

_MODELS: Final[dict[str, tuple[str, str, str | tuple[float, tuple[float, ...]]]]] = {
    "pca": ("#7f7f7f", "s", ":"),
    "ae": ("#E69F00", "v", "--"),
    "vae": ("#CC79A7", "^", "--"),
    "cae": ("#0072B2", "o", "-"),
    "cvae": ("#009E73", "D", "-"),
    "cae_zero": ("#56B4E9", "P", "-."),
    "cae_reversal": ("#332288", "<", (0.0, (5.0, 1.0, 1.0, 1.0))),
    "cae_jacobian": ("#44AA99", "p", "-."),
    "cvae_jacobian": ("#117733", ">", "-."),
    "odd_cae": ("#999933", "d", (0.0, (3.0, 1.0))),
    "scl": ("#D55E00", "X", "-."),
    "isometric": ("#000000", "*", (0.0, (6.0, 1.5, 1.5, 1.5, 1.5, 1.5))),
    "homogeneous": ("#882255", "h", (0.0, (4.0, 1.0, 1.0, 1.0))),
    "low_turning": ("#DDAA33", "x", (0.0, (8.0, 2.0))),
}
"""Colour, marker and dash of each kind of model; those of other distributions are drawn plainly."""


def look_of(name: str) -> Look:
    """The look of a model, condition or task; a plain one under its own name for any other.

    Raises UserError where it is a plug-in's model that does not load.
    """
    if name in KINDS:
        return Look(KINDS[name].label, *_MODELS.get(name, _PLAIN))
    return LOOKS.get(name, Look(name, *_PLAIN))
