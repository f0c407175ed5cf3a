"""How simulated newcomers do with z = u, with the stick's frame, and after two and ten answers.

A newcomer expects Right to lead right, and Up to lead up or away, whichever the demonstrations mostly do, in
their own directions (turned a little; for one person in five the second axis is upside down), and learns from
what they see. They drive at the table of the demo; at a task of the study of alignments only the error is
measured. What was measured is kept in a file and is not measured again. For example:
python scripts/stick_frame.py table_top plane --models cvae homogeneous --people 10 --out stick_frame
"""

import argparse
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment, identity
from latentarm.alignment.demonstrated import CANDIDATES, demonstrated_motions
from latentarm.alignment.error import relative_alignment_error
from latentarm.alignment.frame import fit_frame, right_and_up, view
from latentarm.alignment.meaning import Meaning
from latentarm.alignment.posterior import fit_meaning
from latentarm.alignment.preference import Imprecise
from latentarm.alignment.queries import order_of_questions
from latentarm.alignment.surroundings import Surroundings
from latentarm.alignment.tool_space import ToolSpace
from latentarm.alignment.twists import motion_twists
from latentarm.assistance.controllers.latent import LatentController
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.split import select_episodes
from latentarm.models.decoder import Decoder
from latentarm.models.saving import load_decoder
from latentarm.robots.kinematics.chain import Chain
from latentarm.runs.asking import FASTEST
from latentarm.runs.folder import read_run
from latentarm.runs.samples import load_samples
from latentarm.runs.training import TrainConfig, train_run
from latentarm.tasks.table_top import TableTop
from latentarm_research.drives.drive import STATE_NOISE_RAD, Setup, simulate
from latentarm_research.drives.drives import drive_plan
from latentarm_research.people.own_directions import InOwnDirections
from latentarm_research.people.population import draw_people
from latentarm_research.people.traits import Traits
from latentarm_research.studies.alignment.preset import PRESETS
from latentarm_research.studies.alignment.scene import DecoderCell, learn_decoder, scene_of
from latentarm_research.user_studies.alignments import MainMotions

TABLE: Final = "table_top"
EPISODES: Final = 60
SEEDS: Final = 3
EPOCHS: Final = 16
LIMIT_S: Final = 30.0
ANSWERS: Final = (2, 10)
FROM_PRIOR: Final = "no answers, decoder inverted"


@dataclass(frozen=True, eq=False)
class Scene:
    """What is asked about and judged on: motions of training episodes, and others."""

    chain: Chain
    decoders: tuple[Decoder, ...]
    shown: Motions
    test: Motions
    surroundings: Surroundings

    def expected(self) -> MainMotions:
        """Right, and up or away; a full push is as fast as nearly all motions."""
        directions = np.zeros((2, 6))
        twists = motion_twists(self.chain, self.shown)
        seen = view(self.chain.link_transforms(self.shown.start), "facing")
        directions[:, :3] = right_and_up(twists[:, :3], seen)
        along = np.abs(twists @ directions.T).max(axis=1)
        return MainMotions(self.chain, directions, float(np.quantile(along, FASTEST)))

    def alignments(self, person: Traits, decoder: Decoder, seed: int) -> Mapping[str, Alignment]:
        """By condition."""
        meaning, shown, chain = self.expected(), self.shown, self.chain
        asked = shown[np.arange(min(CANDIDATES, len(shown)))]
        asked = asked[np.array(order_of_questions(chain, asked, max(ANSWERS)))]
        own = InOwnDirections(meaning, person.directions)
        rng = np.random.default_rng([seed, person.number])
        said = Answers(asked, Imprecise(own, person.answer_variation, rng).inputs(asked))

        def in_tool_space(meaning: Meaning) -> Alignment:
            return ToolSpace(meaning, self.surroundings, shown.duration_s).with_arm(decoder, chain)

        prior = Meaning(meaning.directions / meaning.speed_m_s, np.zeros((1, 12)), np.zeros(1), 1.0)
        learned = {
            f"{count} answers": fit_meaning(said[np.arange(count)], chain, self.surroundings, asked).meaning
            for count in ANSWERS
        }
        return {
            "z = u": identity,
            "frame, no answers": fit_frame(decoder, chain, shown.context, "facing"),
            **{name: in_tool_space(one) for name, one in ({FROM_PRIOR: prior} | learned).items()},
        }


def table(model: str, out: Path, seed: int) -> Scene:
    """The demo's table, with decoders that are trained once."""
    dataset, run = out / "table", out / model
    task = TableTop()
    if not dataset.exists():
        write_dataset(task.demonstrate(EPISODES, np.random.default_rng(seed)), dataset)
    if not (run / "config.json").exists():
        config = TrainConfig(dataset, model, run, seeds=SEEDS, seed=seed, epochs=EPOCHS)
        train_run(replace(config, state_noise_rad=STATE_NOISE_RAD))
    samples, chain = load_samples(run), task.robot.chain
    if samples is None or samples.motions is None:
        raise SystemExit(f"{run} keeps no motions.")
    held_out = select_episodes(read_dataset(dataset), np.array(read_run(run).held_out))
    test = demonstrated_motions(held_out, 500, np.random.default_rng(seed))
    decoders = tuple(load_decoder(run, index) for index in range(SEEDS))
    around = Surroundings.of_motions(samples.motions, chain, 2)
    return Scene(chain, decoders, samples.motions, test, around)


def studied(task: str, model: str, seed: int) -> Scene:
    """A task of the study of alignments."""
    scene = scene_of(learn_decoder(DecoderCell(task, model, PRESETS["paper"], seed)))
    shown = scene.shown[np.random.default_rng(seed).permutation(len(scene.shown))[:1000]]
    return Scene(scene.chain, (scene.decoder,), shown, scene.test.motions, scene.surroundings)


def measure(task: str, model: str, asked: argparse.Namespace) -> None:
    """All people in all conditions; one line for each condition."""
    path = asked.out / f"{task}_{model}.json"
    kept: dict[str, dict[str, float]] = json.loads(path.read_text()) if path.exists() else {}
    scene = table(model, asked.out, asked.seed) if task == TABLE else studied(task, model, asked.seed)
    meaning, place = scene.expected(), TableTop()
    plan = drive_plan(place, asked.people, asked.seed)
    conditions: dict[str, list[dict[str, float]]] = {}
    for person in draw_people(asked.people, asked.seed):
        decoder = scene.decoders[person.number % len(scene.decoders)]
        own = InOwnDirections(meaning, person.directions)
        truth = Answers(scene.test, own.inputs(scene.test))
        for name, alignment in scene.alignments(person, decoder, asked.seed).items():
            key = f"{person.number} {name}"
            if key not in kept:
                kept[key] = {"error": relative_alignment_error(alignment, decoder, scene.chain, truth)}
                if task == TABLE and not asked.errors_only:
                    goal = person.number % len(place.goals)
                    _, manner, rng = plan[goal * asked.people + person.number]
                    who = person.newcomer(meaning.usual, 0)
                    setup = Setup(place, LatentController(decoder, alignment), None, who, LIMIT_S)
                    figures = simulate(setup, goal, manner, rng).figures
                    time_s = figures.time_s if figures.success else LIMIT_S
                    kept[key] |= {"done": figures.success, "time_s": time_s}
                path.write_text(json.dumps(kept, indent=1))
            for group in ("everybody", "upside down" if person.mirrored else "upright"):
                conditions.setdefault(f"{group}, {name}", []).append(kept[key])
    for name, of in sorted(conditions.items()):
        print(f"{task}, {model}, {name}, {len(of)} people:", end="")
        for figure in of[0]:
            values = [one[figure] for one in of]
            print(f" {figure} {np.mean(values):.2f} ± {np.std(values, ddof=1):.2f}", end="")
        print(flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tasks", nargs="+", choices=[TABLE, "plane", "pour", "reach_and_pour"])
    parser.add_argument("--models", nargs="+", default=["cvae", "homogeneous"])
    parser.add_argument("--people", type=int, default=10)
    parser.add_argument("--errors-only", action="store_true", help="nobody drives")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("stick_frame"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for of in options.tasks:
        for model in options.models:
            measure(of, model, options)
