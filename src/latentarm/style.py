"""One look for every figure: a colour, a marker and a dash per model and condition, legible without colour."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Look:
    """How one model or condition is drawn everywhere.

    Attributes:
        label: its name as people read it.
        colour: hex colour of the Okabe-Ito palette (distinct for colour-blind readers).
        marker: matplotlib marker, so that the series is told apart in grey too.
        dash: matplotlib line style.
    """

    label: str
    colour: str
    marker: str
    dash: str


LOOKS: dict[str, Look] = {
    "pca": Look("PCA", "#7f7f7f", "s", ":"),
    "ae": Look("AE", "#E69F00", "v", "--"),
    "vae": Look("VAE", "#CC79A7", "^", "--"),
    "cae": Look("cAE", "#0072B2", "o", "-"),
    "cvae": Look("cVAE", "#009E73", "D", "-"),
    "cae_zero": Look("cAE, zero penalty", "#56B4E9", "P", "-."),
    "scl": Look("state-conditioned linear", "#D55E00", "X", "-."),
    "latent": Look("latent actions", "#0072B2", "o", "-"),
    "latent_assist": Look("latent actions + shared autonomy", "#009E73", "D", "-"),
    "end_effector": Look("mode switching", "#7f7f7f", "s", ":"),
}

FIGURE_DPI = 150


def tidy(axes: "Axes") -> None:
    """Strip what does not carry data: upper and right frame lines; a faint grid behind the data."""
    axes.spines["top"].set_visible(False)
    axes.spines["right"].set_visible(False)
    axes.grid(True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
