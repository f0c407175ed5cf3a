"""The trials of a study, of simulated or of real people, and the folder that holds them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast, final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.people.population import draw_people
from latentarm_research.people.traits import Traits
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.user_studies.answers.items import Answer, read_answers
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import PREFIX, Definition
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.record import PeopleAre, Trial, read_trials
from latentarm_research.user_studies.sizes import PRESETS, Sizes
from latentarm_research.user_studies.trace import Trace, read_traces

if TYPE_CHECKING:
    from latentarm_research.user_studies.serving.store import Standing

DEFINITION: Final = "definition.json"
TRIALS: Final = "trials.json"
TRACES: Final = "traces.json"
PEOPLE: Final = "people.json"
DATABASE: Final = "study.sqlite"  # of a served study, in place of trials and traces
SERVED: Final = "served"  # in `CONFIG` of a served study: the options of its first start
DOCUMENTS: Final = (DEFINITION, TRIALS, TRACES, PEOPLE)

PEOPLE_ARE: Final[tuple[PeopleAre, ...]] = ("simulated", "real")


@final
@dataclass(frozen=True, eq=False)
class Recorded:
    """Trials, and whose they are."""

    definition: Definition  # of the study
    people_are: PeopleAre  # who gave the trials
    trials: tuple[Trial, ...]  # of all people
    traces: tuple[Trace, ...]  # of their drives; empty where none were kept
    simulated: tuple[Traits, ...]  # what the simulated people are like; empty for real people
    sizes: Sizes  # of the run
    answers: tuple[Answer, ...] = ()  # on the page of a served study, or from a file
    # of a served study: everybody who has consented, those who have finished first
    participants: "tuple[Standing, ...]" = ()

    @property
    def documents(self) -> dict[str, object]:
        """Contents of a folder's files other than the traces, by file name; the same on every computer."""
        about = self._about
        return {
            DEFINITION: {"digest": self.definition.digest, **self.definition.as_json()},
            TRIALS: {**about, "trials": [one.as_json() for one in self.trials]},
            PEOPLE: {**about, "people": [dict(one.as_json()) for one in self.simulated]},
        }

    @property
    def records(self) -> dict[str, object]:
        """The file of the traces."""
        return {TRACES: {**self._about, "traces": [one.as_json() for one in self.traces]}}

    @property
    def _about(self) -> dict[str, object]:
        return {"definition": self.definition.digest, "people_are": self.people_are}

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
        return self.sizes.people(len(self.met), self.people_are)


def read_recorded(
    folder: Path,
    database: str | None = None,  # URL of a served study's database; None where it is in the folder
    answers: Path | None = None,  # a file with those of real people, in place of the study's own
) -> Recorded:
    """Read a folder of `latentarm study run` or `serve`, or trials of real people with the same documents.

    Of real people it holds ``config.json`` (``study``, ``definition``, ``people_are``), ``trials.json``,
    ``definition.json`` where the study is not one of the paper's, and ``traces.json`` where ways were kept.
    """
    recorded = _read_recorded(folder, database)
    if answers is None:
        return recorded
    if recorded.people_are == "simulated":
        raise UserError(
            f"{folder} holds simulated people, who have no opinions: give --answers of real people only."
        )
    return replace(recorded, answers=tuple(read_answers(answers, recorded.definition, recorded.met)))


def read_config(folder: Path) -> dict[str, Any]:
    """Read the options of a study. Raises a `UserError` if the folder holds no study."""
    if not (folder / CONFIG).exists():
        served = folder.name.removesuffix("-people")
        name = served if served in NAMES else "NAME"
        raise UserError(f"No study is in {folder}: latentarm study run {name}, or serve {name}, makes one.")
    return read_object(folder / CONFIG)


def was_served(folder: Path, database: str | None) -> bool:
    """Check if the study in a folder is one with a database."""
    return database is not None or (folder / DATABASE).exists() or SERVED in read_config(folder)


def _read_recorded(folder: Path, database: str | None) -> Recorded:
    config = read_config(folder)
    definition = _definition(folder, config)
    people_are: Any = config.get("people_are")
    if people_are not in PEOPLE_ARE:
        raise UserError(f"{folder / CONFIG}: people_are must be one of {', '.join(PEOPLE_ARE)}.")
    if was_served(folder, database):
        return _served(definition, folder, database, _sizes(folder / CONFIG, config))
    document = _document(folder / TRIALS, definition)
    if document.get("people_are") != people_are:
        raise UserError(f"{folder / TRIALS}: people_are must be {people_are!r}, as in {CONFIG}.")
    trials = read_trials(document, folder / TRIALS)
    _check_trials(definition, trials, folder / TRIALS)
    path = folder / TRACES
    return Recorded(
        definition,
        people_are,
        trials,
        read_traces(_document(path, definition), path) if path.exists() else (),
        _simulated(folder, config) if people_are == "simulated" else (),
        _sizes(folder / CONFIG, config),
    )


def _served(definition: Definition, folder: Path, database: str | None, sizes: Sizes) -> Recorded:
    """Everybody who has finished a served study."""
    from latentarm_research.user_studies.drive_record import trial_of
    from latentarm_research.user_studies.serving.served_store import served_store  # SQLAlchemy

    with served_store(folder, database) as store:
        people = [one for one in store.people() if one.consented]
    finished = sorted((one for one in people if one.finished), key=lambda one: one.number or 0)
    if not finished:
        raise UserError(f"Nobody has finished the study in {folder} yet.")
    trials: list[Trial] = []
    for one in finished:
        keys = dict.fromkeys((drive.order, drive.task, drive.trial) for drive in one.drives)
        for key in keys:
            theirs = [drive for drive in one.drives if (drive.order, drive.task, drive.trial) == key]
            trials.append(trial_of(definition.measures, theirs))
    traces = tuple(drive.trace for one in finished for drive in one.drives)
    answers = tuple(answer for one in finished for answer in one.answers)
    everybody = (*finished, *(one for one in people if not one.finished))
    return Recorded(definition, "real", tuple(trials), traces, (), sizes, answers, everybody)


def read_definition_of(folder: Path) -> Definition:
    """The definition of the study in a folder."""
    return _definition(folder, read_config(folder))


def _definition(folder: Path, config: Mapping[str, Any]) -> Definition:
    study = str(config.get("study", ""))
    name = study.removeprefix(PREFIX)
    if not study.startswith(PREFIX):
        raise UserError(
            f"{folder} holds no run of a user study: name a folder that latentarm study run made."
        )
    return load_definition(name) if name in NAMES else read_definition(folder / DEFINITION)


def _document(path: Path, definition: Definition) -> dict[str, Any]:
    """A document of trials or traces of a definition."""
    document = read_object(path)
    if document.get("definition") != definition.digest:
        raise UserError(
            f"{path} was made with another definition of the study {definition.name}: run it again, or use"
            " the version of latentarm that made it."
        )
    return document


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
    people, seed = config.get("simulated"), config.get("seed")
    if not isinstance(people, int) or not isinstance(seed, int):
        raise UserError(f"{folder / CONFIG}: simulated and seed must be whole numbers.")
    drawn = draw_people(people, seed)
    if read_object(folder / PEOPLE).get("people") != [dict(one.as_json()) for one in drawn]:
        raise UserError(
            f"{folder / PEOPLE} has other people than this version draws: use the one that made it."
        )
    return drawn


def _sizes(path: Path, config: dict[str, Any]) -> Sizes:
    sizes = config.get("preset")
    name = str(cast(dict[str, Any], sizes).get("name")) if isinstance(sizes, dict) else "paper"
    if name not in PRESETS:
        raise UserError(f"{path}: preset must be one of: {', '.join(PRESETS)}.")
    return PRESETS[name]
