"""`latentarm study`: the paper's user studies, gone through by simulated people."""

import json as json_format
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

from rich.table import Table
from tyro.conf import Positional, arg

from latentarm.commands.output import print_renderables, say
from latentarm.core.errors import UserError
from latentarm.runs.options import Json, Seed
from latentarm_research.commands.study_options import StudyName, StudyOptions, run_and_show
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.own.definition_file import find_definition
from latentarm_research.user_studies.sizes import PRESETS

Simulated = Annotated[
    int | None,
    arg(metavar="N", help="How many simulated people; by default as many as the definition plans."),
]
Preset = Annotated[
    str,
    arg(
        metavar="{" + ",".join(PRESETS) + "}",
        help="paper: whole sizes; smoke: one trial of a second at each task, which only shows that it runs.",
    ),
]


def list_studies(json: Json = False) -> int:
    """List the paper's user studies.

    For example: latentarm study list
    """
    definitions = [load_definition(name) for name in NAMES]
    if json:
        found = [{"name": one.name, "section": one.section, "title": one.title} for one in definitions]
        print(json_format.dumps(found, indent=2))
        return 0
    table = Table("study", "section", "conditions", "tasks", title="User studies of the paper")
    for one in definitions:
        conditions, tasks = (", ".join(names) for names in _names(one))
        table.add_row(one.name, one.section, conditions, tasks)
    print_renderables(table)
    return 0


def show_study(name: Positional[StudyName], json: Json = False) -> int:
    """Show a study's definition: conditions, tasks, hypotheses with their tests, and its hash.

    For example: latentarm study show eating
    """
    from latentarm_research.user_studies.analysis.analysis import worded

    definition = find_definition(name)
    if json:
        print(json_format.dumps({"digest": definition.digest, **definition.as_json()}, indent=2))
        return 0
    conditions = Table("condition", "what it is", title=_titled(definition))
    for one in definition.conditions:
        conditions.add_row(one.name, one.about)
    claims = Table("", "claim", title="Hypotheses")
    for hypothesis in definition.hypotheses:
        claims.add_row(hypothesis.name, hypothesis.text)
        for claim in hypothesis.claims:
            claims.add_row("", worded(definition, claim))
    print_renderables(conditions, claims, f"{definition.people} people. Definition {definition.digest}")
    return 0


def run_study(
    name: Positional[StudyName],
    options: StudyOptions,
    simulated: Simulated = None,
    preset: Preset = "paper",
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for report and figures; studies/NAME.")
    ] = None,
) -> int:
    """Send simulated people through a study, analyse their trials, and write the report.

    For example: latentarm study run harmonic --simulated 2 --preset smoke
    """
    from latentarm_research.user_studies.run import study_of
    from latentarm_research.user_studies.sizes import sizes_of

    definition = find_definition(name)
    folder = Path("studies", definition.name) if out is None else out
    sizes = sizes_of(preset, definition.people if simulated is None else simulated)
    request = options.request(folder, sizes, tuple(task.name for task in definition.tasks))
    run_and_show(study_of(definition, name), request, "study run", page="report.html")
    return 0


def power_of_study(
    name: Positional[StudyName],
    results: Annotated[Path, arg(metavar="DIR", help="Folder of a run of this study.")],
    draws: Annotated[int, arg(help="Studies drawn for each number of people.")] = 200,
    seed: Seed = 0,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for power.json; by default studies/NAME-power.")
    ] = None,
    json: Json = False,
) -> int:
    """Find how many people a study needs: studies drawn from simulated people, through its own analysis.

    For example: latentarm study power harmonic --results studies/harmonic
    """
    from latentarm.runs.results_folder import write_json
    from latentarm_research.studies.results_folder import ResultsFolder
    from latentarm_research.user_studies.power import TARGETS, power_of
    from latentarm_research.user_studies.recorded import read_recorded

    definition = find_definition(name)
    folder = Path("studies", f"{definition.name}-power") if out is None else out
    claimed = ResultsFolder(f"power of {definition.study}", ("power.json",))
    recorded = read_recorded(results)
    found = recorded.definition
    if found != definition:
        raise UserError(
            f"{results} holds a run of the study {found.name}, definition {found.digest[:12]}: name a run of"
            f" {definition.name}, definition {definition.digest[:12]}."
        )
    about = {"study": claimed.name, "definition": definition.digest, "draws": draws, "seed": seed}
    claimed.claim(folder, {**about, "drawn_from": str(results)})
    power = power_of(definition, recorded.trials, draws, seed)
    write_json(folder / "power.json", power.as_json())
    if json:
        print(json_format.dumps(power.as_json(), indent=2))
        return 0
    table = Table("", "80 %", "90 %", title=f"People needed, drawn from {power.people} simulated people")
    for what, shares in {**power.hypotheses, **power.claims}.items():
        needed = (power.needed(shares, target) for target in TARGETS)
        table.add_row(
            what, *(f"more than {power.numbers[-1]}" if one is None else str(one) for one in needed)
        )
    print_renderables(table)
    say(f"How often each claim holds with how many people is in {folder}/power.json.", json)
    return 0


def preregister_study(
    name: Positional[StudyName],
    power: Annotated[
        Path | None, arg(metavar="DIR", help="Folder that latentarm study power has written.")
    ] = None,
    out: Annotated[Path | None, arg(metavar="FILE", help="By default NAME-preregistration.json.")] = None,
    json: Json = False,
) -> int:
    """Write a study's plan with its hypotheses, analysis and power into one document with a hash.

    For example: latentarm study preregister eating --power studies/eating-power
    """
    from latentarm.core.untrusted.documents import read_object
    from latentarm.runs.results_folder import write_json
    from latentarm_research.user_studies.preregistration import preregistration

    definition = find_definition(name)
    path = Path(f"{definition.name}-preregistration.json") if out is None else out
    if path.exists():
        raise UserError(f"{path} already exists: name another file with --out.")
    computed = None if power is None else read_object(power / "power.json")
    document = preregistration(definition, computed, datetime.now(UTC).isoformat(timespec="seconds"))
    write_json(path, document)
    say(f"The preregistration is in {path}, with the digest {document['digest']}.", json)
    if json:
        print(json_format.dumps({"file": str(path), "digest": document["digest"]}))
    return 0


def _titled(definition: Definition) -> str:
    return definition.title + (f" (section {definition.section})" if definition.section else "")


def _names(definition: Definition) -> tuple[list[str], list[str]]:
    return [one.name for one in definition.conditions], [one.label for one in definition.tasks]
