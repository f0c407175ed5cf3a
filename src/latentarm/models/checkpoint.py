"""Checkpoints of a training: one safetensors file, written whole or not at all."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, final

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.core.untrusted.opening import check_file
from latentarm.models.optimiser import FlatAdam

_HEADER_BYTES: Final = 1 << 26  # bytes that the names and the loss history may take: 64 MiB
METADATA_KEY: Final = "latentarm_training"


@final
@dataclass
class TrainingState:
    """Everything that the next epoch depends on; updated in place.

    ``values``, ``first`` and ``second`` are the trainer's own buffers: weights, and Adam's running means of
    the gradient and of its square.
    """

    values: Tensor  # (S, P)
    first: Tensor  # (S, P)
    second: Tensor  # (S, P)
    best: Tensor  # (S, P), each seed's weights at its best epoch
    best_loss: FloatArray  # (S,), validation loss there; infinite before the first epoch
    best_epoch: IntArray  # (S,), counted from 1
    epoch: int = 0
    steps: int = 0
    history: list[list[float]] = field(default_factory=list[list[float]])  # losses (S,) by epoch

    @staticmethod
    def start(values: Tensor, adam: FlatAdam) -> "TrainingState":
        """The state before the first epoch, over the trainer's own buffers."""
        return TrainingState(
            values=values,
            first=adam.first,
            second=adam.second,
            best=torch.zeros_like(values),
            best_loss=np.full(len(values), np.inf),
            best_epoch=np.zeros(len(values), dtype=np.int64),
        )

    def stalled(self, patience: int) -> BoolArray:
        """Which seeds (S,) have gone ``patience`` epochs without improving."""
        return self.epoch - self.best_epoch >= patience

    def record(self, loss: FloatArray, steps: int, patience: int) -> None:
        """Take in the validation loss (S,) after one more epoch.

        A stalled seed keeps its best weights even if it would improve later: trained alone, it would have
        stopped there.
        """
        improved = (loss < self.best_loss) & ~self.stalled(patience)
        self.epoch += 1
        self.steps = steps
        self.history.append(loss.tolist())
        self.best_loss = np.where(improved, loss, self.best_loss)
        self.best_epoch = np.where(improved, self.epoch, self.best_epoch)
        chosen = torch.from_numpy(improved).to(self.best.device)
        self.best[chosen] = self.values[chosen]

    def tensors(self) -> dict[str, Tensor]:
        """The buffers by name."""
        return {"values": self.values, "first": self.first, "second": self.second, "best": self.best}


def fingerprint(settings: Mapping[str, object], arrays: Sequence[FloatArray]) -> str:
    """SHA-256 of everything that determines a training's result; a checkpoint with another one is refused."""
    digest = hashlib.sha256(json.dumps(settings, sort_keys=True).encode())
    for array in arrays:
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def write_checkpoint(path: Path, print_of: str, state: TrainingState) -> None:
    """Write the state, replacing an older checkpoint whole; UserError where the file cannot be written."""
    progress = {
        "fingerprint": print_of,
        "epoch": state.epoch,
        "steps": state.steps,
        "best_loss": state.best_loss.tolist(),
        "best_epoch": state.best_epoch.tolist(),
        "history": state.history,
    }
    tensors = {name: tensor.detach().cpu() for name, tensor in state.tensors().items()}
    # safetensors reports a full disk as an error of its own type.
    content = save(tensors, metadata={METADATA_KEY: json.dumps(progress)})
    with written_whole(path) as part:
        part.write_bytes(content)


def read_checkpoint(path: Path, print_of: str, state: TrainingState) -> None:
    """Fill ``state`` from the file; UserError where it is broken, foreign, or of another training."""
    check_file(path, _HEADER_BYTES + sum(tensor.nbytes for tensor in state.tensors().values()))
    try:
        with safe_open(path, framework="pt") as stream:
            progress = json.loads((stream.metadata() or {})[METADATA_KEY])
            if progress["fingerprint"] != print_of:
                raise UserError(
                    f"{path} is the checkpoint of another training (its data or parameters differ); "
                    "delete it to start afresh."
                )
            for name, tensor in state.tensors().items():
                tensor.copy_(stream.get_tensor(name))
        state.epoch, state.steps = int(progress["epoch"]), int(progress["steps"])
        state.best_loss = np.array(progress["best_loss"], dtype=np.float64)
        state.best_epoch = np.array(progress["best_epoch"], dtype=np.int64)
        state.history = [[float(loss) for loss in losses] for losses in progress["history"]]
    except (SafetensorError, OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise UserError(f"{path} is not a whole training checkpoint; delete it to start afresh.") from error
