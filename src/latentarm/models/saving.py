"""A trained model on disk: ``model.safetensors`` and the ``model`` key of ``config.json``. NumPy only.

A file's sizes are checked before anything is allocated, then the weights' SHA-256, then every tensor's name,
shape, dtype and finiteness. Nothing is unpickled.
"""

import hashlib
import json
import math
import platform
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from latentarm.core.context import EARLIER_NAMES, ContextLayout, feature_names
from latentarm.core.errors import UserError
from latentarm.core.files import write_text, written_whole
from latentarm.core.plugins import Origin
from latentarm.core.types import FloatArray, StrPath
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.contexts import GRIPPER_SOURCES
from latentarm.models.catalogue import KINDS
from latentarm.models.decoder import Decoder
from latentarm.models.kind import Dimensions, Shape, TrainedModel, TrainingSummary
from latentarm.models.reading import Section
from latentarm.models.way_back.runtime import pull_shapes

CONFIG_NAME: Final = "config.json"
WEIGHTS_NAME: Final = "model.safetensors"
SCHEMA: Final = 4
EARLIER_SCHEMAS: Final = (2, 3)  # they have no layout; their contexts are the joints, perhaps with a belief
OLD_NAMES: Final = {
    "held_out_fraction": "validation_fraction",
    "held_out_episodes": "validation_episodes",
    "held_out_loss": "validation_loss",
}
"""Names of schema 2."""
CONFIG_LIMIT: Final = 16 * 2**20
"""Bytes; a config with the training curves of a hundred seeds stays far below."""
MOST_LAYERS: Final = 64
HEADER_LIMIT: Final = 2**20
WEIGHTS_LIMIT: Final = 2**30
LINKS: Final = ("chain.parent", "chain.tool_link")
PACKAGES: Final = ("latentarm", "numpy", "safetensors", "scikit-learn", "torch")


def write_model(folder: Path, trained: TrainedModel, run: Mapping[str, object]) -> None:
    """Write a model to a folder, each file whole or not at all; ``run`` has further keys of ``config.json``.

    Raises UserError where the files cannot be written.
    """
    sha256 = write_tensors(folder / WEIGHTS_NAME, trained.tensors)
    summary = trained.summary
    origin = KINDS.origin(trained.kind.name)
    section = {
        "schema": SCHEMA,
        "kind": trained.kind.name,
        **({} if origin is None else {"distribution": origin.distribution}),
        "parameters": dict(trained.parameters),
        "dimensions": {
            key: value for key, value in asdict(trained.dimensions).items() if key != "coupled" or value
        },
        "layout": {key: value for key, value in asdict(trained.layout).items() if key != "joints"},
        "seeds": list(summary.seeds),
        "training": {
            "validation_episodes": list(summary.validation_episodes),
            "validation_loss": summary.validation_loss.tolist(),
            "best_epoch": summary.best_epoch.tolist(),
            "history": [
                [loss if math.isfinite(loss) else None for loss in epoch]
                for epoch in summary.history.tolist()
            ],
        },
        "collapsed": summary.collapsed.tolist(),
        "tensors": {key: {"shape": list(one.shape), "dtype": "F64"} for key, one in trained.tensors.items()},
        "sha256": sha256,
        "versions": {"python": platform.python_version(), **_versions(origin)},
    }
    write_text(folder / CONFIG_NAME, json.dumps({**run, "model": section}, indent=2) + "\n")


def read_model(folder: Path) -> TrainedModel:
    """Read and check a model; UserError where files are missing, foreign, of other versions, or disagree."""
    path = folder / CONFIG_NAME
    section = Section.of_file(path, CONFIG_LIMIT).section("model")
    schema = section.integer("schema", 0)
    if schema not in (*EARLIER_SCHEMAS, SCHEMA):
        raise UserError(
            f"{path} has schema {schema} and this version reads schemas {EARLIER_SCHEMAS[0]} to {SCHEMA}:"
            " train the model again."
        )
    name, origin = section.text("kind"), section.plain().get("distribution")
    kind = KINDS.find(name, str(path), origin if isinstance(origin, str) else None)
    sizes = section.section("dimensions")
    dimensions = Dimensions(
        seeds=sizes.integer("seeds", 1),
        latent=sizes.integer("latent", 1),
        context=sizes.integer("context", 1),
        action=sizes.integer("action", 1),
        hidden=tuple(sizes.integers("hidden", 1, longest=MOST_LAYERS)),
        tools=sizes.integer("tools", 0),
        coupled=sizes.integer("coupled", 0) if "coupled" in sizes.plain() else 0,
        way_back=_way_back(sizes),
    )
    if kind.sees_tools and (dimensions.tools < 1 or dimensions.context < dimensions.action):
        raise UserError(
            f"{path}: a model of kind '{name}' has at least one tool, and the state in its context."
        )
    if dimensions.coupled and not (dimensions.tools and dimensions.coupled > dimensions.action):
        raise UserError(f"{path}: an arm whose links follow joints has a tool, and more links than joints.")
    parameters = _renamed(section.section("parameters"))
    earlier = schema in EARLIER_SCHEMAS
    layout = (
        _earlier_layout(parameters, dimensions) if earlier else _layout(section.section("layout"), dimensions)
    )
    if dimensions.way_back and dimensions.tools < 1:
        raise UserError(f"{path}: a way back needs an arm with a tool.")
    shapes = {**kind.tensor_shapes(dimensions), **pull_shapes(dimensions, layout)}
    training = _renamed(section.section("training"))
    seeds = dimensions.seeds
    summary = TrainingSummary(
        seeds=tuple(section.integers("seeds", 0, length=seeds)),
        validation_episodes=tuple(training.integers("validation_episodes", 0)),
        validation_loss=training.array("validation_loss", (seeds,)),
        best_epoch=training.array("best_epoch", (seeds,)).astype(np.int64),
        history=training.array("history", (None, seeds), gaps=True),
        collapsed=section.array("collapsed", (seeds, dimensions.latent)).astype(np.bool_),
    )
    tensors = read_tensors(folder / WEIGHTS_NAME, shapes, section.text("sha256"))
    return TrainedModel(kind, parameters.plain(), dimensions, layout, tensors, summary)


def _way_back(sizes: Section) -> tuple[int, ...]:
    """Hidden units of the way back's network; models from before there was one have none."""
    if "way_back" not in sizes.plain():
        return ()
    return tuple(sizes.integers("way_back", 1, longest=MOST_LAYERS))


def _earlier_layout(parameters: Section, dimensions: Dimensions) -> ContextLayout:
    features = EARLIER_NAMES[parameters.choice("context", tuple(EARLIER_NAMES))]
    goals = max(dimensions.context - dimensions.action, 0)
    return _checked(ContextLayout(features, dimensions.action, goals), dimensions, parameters.where)


def _layout(section: Section, dimensions: Dimensions) -> ContextLayout:
    """The layout of contexts in a model's file."""
    try:
        features = feature_names(section.texts("features"))
    except UserError as error:
        raise UserError(f"{section.where}: {error}") from error
    layout = ContextLayout(
        features=features,
        joints=dimensions.action,
        goals=section.integer("goals", 0),
        objects=tuple(section.texts("objects")),
        gripper=section.choice("gripper", ("", *GRIPPER_SOURCES)),
    )
    return _checked(layout, dimensions, section.where)


def _checked(layout: ContextLayout, dimensions: Dimensions, where: str) -> ContextLayout:
    if layout.width != dimensions.context:
        raise UserError(
            f"{where}: its features have {layout.width} entries, and its contexts {dimensions.context}."
        )
    if layout.sees_tool_frame and dimensions.tools < 1:
        raise UserError(f"{where}: poses in the tool's frame need an arm with a tool.")
    return layout


def _renamed(section: Section) -> Section:
    """The section with today's names for what schema 2 called otherwise."""
    return Section(section.where, {OLD_NAMES.get(key, key): value for key, value in section.values.items()})


def write_tensors(path: Path, tensors: Mapping[str, FloatArray]) -> str:
    """Write tensors to a safetensors file, whole or not at all; its SHA-256, for the file that describes it.

    Raises UserError where it cannot be written.
    """
    content = save({name: np.ascontiguousarray(tensors[name]) for name in sorted(tensors)})
    with written_whole(path) as part:
        part.write_bytes(content)
    return hashlib.sha256(content).hexdigest()


def read_tensors(path: Path, shapes: Mapping[str, Shape], sha256: str) -> dict[str, FloatArray]:
    """The tensors of a safetensors file of this SHA-256, after every check against ``config.json``.

    Raises UserError where the file is missing, or another than its ``config.json`` describes.
    """
    payload = 8 * sum(int(np.prod(shape, dtype=object)) for shape in shapes.values())
    if payload > WEIGHTS_LIMIT:
        raise UserError(
            f"{path.parent / CONFIG_NAME} asks for {payload:.3g} bytes of weights: it is not a model's."
        )
    content = read_bytes(path, 8 + HEADER_LIMIT + payload)
    header = int.from_bytes(content[:8], "little")
    if header > HEADER_LIMIT or len(content) != 8 + header + payload:
        raise UserError(
            f"{path} is not what its {CONFIG_NAME} describes: it has {len(content)} bytes, a header of "
            f"{header}, and {payload} bytes of weights belong in it."
        )
    if hashlib.sha256(content).hexdigest() != sha256:
        raise UserError(
            f"{path} does not have the SHA-256 that its {CONFIG_NAME} holds: one of the two was changed."
        )
    try:
        tensors = load(content)
    except (SafetensorError, KeyError, ValueError, TypeError) as error:
        raise UserError(f"{path} is not a safetensors file.") from error
    for name in sorted(set(tensors) ^ set(shapes)):
        raise UserError(f"{path} {'lacks' if name in shapes else 'holds an unknown'} tensor '{name}'.")
    for name, array in tensors.items():
        if array.dtype != np.float64 or array.shape != shapes[name]:
            raise UserError(
                f"{path}: tensor '{name}' is {array.dtype} {array.shape}, not float64 {shapes[name]}."
            )
        if not np.isfinite(array).all():
            raise UserError(f"{path}: tensor '{name}' holds a NaN or an infinity.")
        if name.endswith(".scale") and not (array > 0).all():
            raise UserError(f"{path}: tensor '{name}' holds a scale that is not positive.")
        if name in LINKS and not _are_links(array, tensors["chain.parent"].size, name == "chain.parent"):
            raise UserError(f"{path}: tensor '{name}' names links that the arm does not have.")
    return tensors


def _are_links(links: FloatArray, joints: int, each_before_its_own: bool) -> bool:
    """Whether these are indices of links, -1 for the base; of parents, each that of an earlier link."""
    limit = np.arange(len(links)) if each_before_its_own else joints
    return bool(((links == np.round(links)) & (links >= -1) & (links < limit)).all())


def _versions(origin: Origin | None) -> dict[str, str]:
    versions = {} if origin is None else {origin.distribution: origin.version}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed as a package"
    return versions


def load_decoder(folder: StrPath, seed: int = 0) -> Decoder:
    """Read the decoder of a seed, 0..S-1, from a folder that a model was saved to. Loads no torch.

    Raises UserError where the files are missing, broken or foreign, or there is no such seed.
    """
    return Decoder(read_model(Path(folder)), seed)
