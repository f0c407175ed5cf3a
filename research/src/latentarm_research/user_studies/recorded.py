"""A run's folder read again, of simulated or of real people."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, cast, final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.runs.results_folder import CONFIG
from latentarm_research.people.population import draw_people
from latentarm_research.people.traits import Traits
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.folder import TRACES, TRIALS, read_trials
from latentarm_research.user_studies.own.records import read_record
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.sizes import PRESETS, Sizes
from latentarm_research.user_studies.trace import Trace

PeopleAre = Literal["simulated", "real"]

PEOPLE_ARE: Final[tuple[PeopleAre, ...]] = ("simulated", "real")


@final
@dataclass(frozen=True, eq=False)
class Recorded:
    """What a folder holds.

    Attributes:
        definition: of the study.
        people_are: who gave the trials.
        trials: of all people.
        traces: of their drives; empty where none were kept.
        simulated: what the simulated people are like; empty for real people.
        sizes: of the run; whole for real people.
    """

    definition: Definition
    people_are: PeopleAre
    trials: tuple[Trial, ...]
    traces: tuple[Trace, ...]
    simulated: tuple[Traits, ...]
    sizes: Sizes

    @property
    def met(self) -> dict[int, set[str]]:
        """The conditions that each person met."""
        found: dict[int, set[str]] = {}
        for trial in self.trials:
            found.setdefault(trial.person, set()).add(trial.condition)
        return found

    @property
    def who(self) -> str:
        """The people in words, such as ``12 simulated people``."""
        number = len(self.met)
        return self.sizes.people(number) if self.people_are == "simulated" else f"{number} real people"


def read_recorded(folder: Path) -> Recorded:
    """Read a folder of `latentarm study run`, or one of trials of real people with the same documents.

    Of real people it holds ``config.json`` (``study``, ``definition``, ``people_are``), ``trials.json``,
    ``definition.json`` where the study is not one of the paper's, and ``traces.json`` where ways were kept.

    Raises:
        UserError: a document is missing, wrong, or of another definition or other people than the others.
    """
    definition, trials = read_trials(folder)
    config, document = read_object(folder / CONFIG), read_object(folder / TRIALS)
    said: Any = config.get("people_are")
    if said not in PEOPLE_ARE:
        raise UserError(f"{folder / CONFIG}: people_are must be one of {', '.join(PEOPLE_ARE)}.")
    if document.get("people_are") != said:
        raise UserError(f"{folder / TRIALS}: people_are must be {said!r}, as in {CONFIG}.")
    _check_trials(definition, trials, folder / TRIALS)
    simulated = _simulated(folder, config) if said == "simulated" else ()
    traces = _traces(folder / TRACES, definition)
    return Recorded(definition, said, tuple(trials), traces, simulated, _sizes(folder / CONFIG, config))


def _check_trials(definition: Definition, trials: Sequence[Trial], path: Path) -> None:
    conditions = {one.name for one in definition.conditions}
    tasks = {one.name for one in definition.tasks}
    met: dict[int, str] = {}
    seen: set[tuple[int, str, str, int]] = set()
    if not trials:
        raise UserError(f"{path} holds no trials.")
    for index, one in enumerate(trials):
        where = f"{path}, trial {index}"
        if one.condition not in conditions or one.task not in tasks:
            raise UserError(
                f"{where}: the study has no condition {one.condition!r} with the task {one.task!r}."
            )
        key = (one.person, one.condition, one.task, one.trial)
        if key in seen:
            raise UserError(f"{where}: person {one.person} has this trial of {one.condition} before.")
        seen.add(key)
        other = met.setdefault(one.person, one.condition)
        if definition.design == "between" and other != one.condition:
            raise UserError(
                f"{where}: person {one.person} has {other} and {one.condition}, but each person meets one"
                " condition."
            )


def _simulated(folder: Path, config: dict[str, Any]) -> tuple[Traits, ...]:
    """Drawn again, and compared with what the folder says."""
    people, seed = config.get("people"), config.get("seed")
    if not isinstance(people, int) or not isinstance(seed, int):
        raise UserError(f"{folder / CONFIG}: people and seed must be whole numbers.")
    drawn = draw_people(people, seed)
    if read_object(folder / "people.json").get("people") != [dict(one.as_json()) for one in drawn]:
        raise UserError(
            f"{folder / 'people.json'} has other people than this version draws: use the one that made it."
        )
    return drawn


def _sizes(path: Path, config: dict[str, Any]) -> Sizes:
    sizes = config.get("sizes")
    name = str(cast(dict[str, Any], sizes).get("name")) if isinstance(sizes, dict) else "paper"
    if name not in PRESETS:
        raise UserError(f"{path}: the sizes must be those of a preset: {', '.join(PRESETS)}.")
    return PRESETS[name]


def _traces(path: Path, definition: Definition) -> tuple[Trace, ...]:
    if not path.exists():
        return ()
    document = read_object(path)
    entries = document.get("traces")
    if document.get("definition") != definition.digest or not isinstance(entries, list):
        raise UserError(f"{path} must hold a list of traces of the same definition.")
    listed = enumerate(cast(list[object], entries))
    return tuple(read_record(Trace, entry, f"{path}, trace {index}") for index, entry in listed)
