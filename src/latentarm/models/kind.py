"""A kind of latent action model without its training, and a trained model."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, final

from latentarm.core.context import ContextLayout
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.models.enclosure import Enclosure
from latentarm.models.numpy_networks import network_shapes
from latentarm.models.saved_chain import chain_of_tensors, chain_shapes
from latentarm.models.scaling import Normaliser
from latentarm.models.tool_contexts import ToolContexts, ToolGeometry, tool_shapes
from latentarm.models.tool_frame import ToolFrame

Encoder = Literal["projection", "nearest", "deterministic", "gaussian"]
Shape = tuple[int, ...]


@dataclass(frozen=True)
class Dimensions:
    """The sizes that fix every tensor's shape."""

    seeds: int  # S, models trained side by side
    latent: int  # d
    context: int  # c
    action: int  # m
    hidden: tuple[int, ...]  # units of each hidden layer, the same in encoder and decoder
    tools: int = 0  # k, end-effectors of the arm; 0 where nothing of the model looks at them
    coupled: int = 0  # L, links of that arm; 0 where none of them follows a joint of another
    way_back: tuple[int, ...] = ()  # units of each hidden layer of the way back's network, if there is one


class Runtime(ABC):
    """phi of one trained seed as the control loop runs it: NumPy only, a few microseconds."""

    @abstractmethod
    def __init__(self, trained: "TrainedModel", seed: int) -> None:
        """Take one seed's decoder out of a trained model. The seed exists."""

    @abstractmethod
    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Joint velocities (..., m), rad/s, of inputs (..., d) in contexts (..., c), which broadcast."""

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure | None:
        """A proven enclosure of the actions of all inputs in [-1, 1]^d in contexts (..., c).

        None where none is proven, as here: then nothing is claimed about how far help constrains the arm. A
        finer one is tighter and takes longer; ``fineness`` is 1 for a control loop.
        """
        return None


@final
@dataclass(frozen=True, kw_only=True)
class ModelKind:
    """Everything that the project knows about a kind of model, except how it is trained."""

    name: str  # on disk, on the command line and in results
    label: str  # its name in figures and tables
    # The class that trains it, a `LatentActionModel`, as ``package.module:Class``. It is imported when a
    # model is trained, so that running one needs no torch.
    estimator: str
    runtime: type[Runtime]  # the decoder in NumPy
    # Layer widths, input first, by network, of the networks that decode
    decoder: Callable[[Dimensions], Mapping[str, Shape]]
    # ``projection`` onto the columns of the decoder or the ``nearest`` action that it can decode (neither has
    # weights), or a network of (c, a) whose output is z (``deterministic``) or (mu, log sigma^2)
    # (``gaussian``)
    encoder: Encoder
    sees_context: bool = True
    # Whether z = 0 means rest, phi(0, c) = 0, by the model's definition, so that it must stay u = 0. Where it
    # does not, u = 0 is the mean latent action of the demonstrations.
    rests_at_zero: bool = False
    reverses: bool = False  # whether it rests, and the opposite input goes back, by construction
    # For models that look at the arm's tools, weight of a joint's motion by 1 rad in the metric of the tools,
    # relative to the square of a tool's motion by 1 m: enough that motions that no tool shows have a cost.
    # None for models that do not look.
    damping_m2: float | None = None
    # L of the way back that `train` adds unless another is named, m; 0 where no measurement speaks for one
    way_back_m: float = 0.0
    advice: str = ""  # one sentence on which model to try next and why; "" if nothing was measured
    # Shown on the page to people who choose a model. For our own models the page's texts say it.
    description: str = ""

    @property
    def sees_tools(self) -> bool:
        """Whether it looks at the arm's tools and their Jacobians, so that fitting needs a known arm."""
        return self.damping_m2 is not None

    @property
    def learns_encoder(self) -> bool:
        """Whether its encoder is a network, rather than a search for the nearest action."""
        return self.encoder in ("deterministic", "gaussian")

    def weight_shapes(self, dimensions: Dimensions) -> dict[str, Shape]:
        """Shape of every learned tensor by name, see `network_shapes`."""
        inputs, d = dimensions.context + dimensions.action, dimensions.latent
        outputs = {"deterministic": d, "gaussian": 2 * d}.get(self.encoder)
        networks = dict(self.decoder(dimensions))
        if outputs is not None:
            networks["encoder"] = (inputs, *dimensions.hidden, outputs)
        return network_shapes(networks, dimensions.seeds)

    def tensor_shapes(self, dimensions: Dimensions) -> dict[str, Shape]:
        """Shape of every tensor of a saved model: the learned ones, the normalisers and the latent scale."""
        arm = dimensions.action, dimensions.tools, dimensions.coupled
        return {
            **self.weight_shapes(dimensions),
            **(chain_shapes(*arm) if dimensions.tools else {}),
            **(tool_shapes(dimensions.tools) if self.sees_tools else {}),
            "context.centre": (dimensions.context,),
            "context.scale": (dimensions.context,),
            "action.scale": (1,),
            "latent.centre": (dimensions.seeds, dimensions.latent),
            "latent.scale": (dimensions.seeds, dimensions.latent),
        }


@final
@dataclass(frozen=True)
class TrainingSummary:
    """Summary of a training."""

    seeds: tuple[int, ...]
    validation_episodes: tuple[int, ...]  # indices of the episodes that decided when training stopped
    validation_loss: FloatArray  # (S,), loss on their pairs, in normalised units
    best_epoch: IntArray  # (S,), the epoch whose weights were kept, counted from 1
    history: FloatArray  # (E, S), validation loss after each epoch, possibly NaN; E = 0 without epochs
    collapsed: BoolArray  # (S, d), latent dimensions that move nothing


@final
@dataclass(frozen=True)
class TrainedModel:
    """The result of a fit as plain arrays, which is saved, loaded and run."""

    kind: ModelKind
    parameters: Mapping[str, object]  # constructor's arguments, as JSON values
    dimensions: Dimensions
    layout: ContextLayout
    tensors: Mapping[str, FloatArray]  # float64 arrays by name, see `ModelKind.tensor_shapes`
    summary: TrainingSummary

    @property
    def frame(self) -> ToolFrame | None:
        """Turns poses in contexts into the frame of the arm's tool; None where no feature asks for it."""
        return ToolFrame(chain_of_tensors(self.tensors), self.layout) if self.layout.sees_tool_frame else None

    @property
    def contexts(self) -> Normaliser | ToolContexts:
        """The map from contexts (..., c), after `frame` if there is one, to the networks' inputs."""
        if self.kind.sees_tools:
            return self.tool_contexts
        return Normaliser(self.tensors["context.centre"], self.tensors["context.scale"])

    @cached_property
    def geometry(self) -> ToolGeometry:
        """The geometry of the arm, shared by all parts of a decoder."""
        if self.kind.sees_tools:
            return self.tool_contexts.geometry
        return ToolGeometry(chain_of_tensors(self.tensors))

    @cached_property
    def tool_contexts(self) -> ToolContexts:
        """`contexts` of a model that looks at the tools; UserError where it does not."""
        if self.kind.damping_m2 is None:
            raise UserError(f"A {self.kind.name} model does not look at the arm's tools.")
        return ToolContexts.of_tensors(self.tensors, self.kind.damping_m2)

    @property
    def actions(self) -> Normaliser:
        """Normaliser of actions (..., m)."""
        scale = self.tensors["action.scale"]
        return Normaliser(0.0 * scale, scale)

    @property
    def latents(self) -> Normaliser:
        """From latent actions as trained (S, N, d) to inputs u."""
        return Normaliser(self.tensors["latent.centre"][:, None], self.tensors["latent.scale"][:, None])

    def check_seed_index(self, seed: int) -> None:
        """Raise a UserError unless ``seed`` is within 0..S-1."""
        if not 0 <= seed < self.dimensions.seeds:
            raise UserError(
                f"This model has no seed index {seed}: it was trained with {self.dimensions.seeds} "
                f"(0 to {self.dimensions.seeds - 1})."
            )
