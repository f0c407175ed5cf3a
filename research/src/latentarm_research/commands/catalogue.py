"""The commands that this distribution adds to the command line; nothing of them is imported here."""

from typing import Final

from latentarm.commands.catalogue import CommandEntry, CommandSet
from latentarm_research.measurements.catalogue import MEASUREMENTS
from latentarm_research.studies.catalogue import STUDIES


def _ours(module: str, summary: str) -> CommandEntry:
    return CommandEntry(f"latentarm_research.commands.{module}", summary)


COMMANDS: Final = CommandSet(
    {
        "demo": _ours(
            "demo:demo",
            "Learn latent actions and stab marshmallows with a 7-DoF Panda in physics,"
            " against mode switching.",
        ),
        "compare": _ours(
            "compare:compare",
            "Compare all models on recorded demonstrations, with every episode held out once.",
        ),
        "drive": _ours(
            "drive:drive",
            "Drive an arm in simulation with a simulated operator, through Algorithm 1"
            " and its safety filters.",
        ),
        **{
            f"reproduce {name}": _ours(f"reproduce:{name.replace('-', '_')}", entry.summary)
            for name, entry in STUDIES.items()
        },
        **{
            f"measure {name}": _ours(f"measure:{name.replace('-', '_')}", entry.summary)
            for name, entry in MEASUREMENTS.items()
        },
        "study list": _ours("study:list_studies", "List the paper's user studies."),
        "study show": _ours(
            "study:show_study",
            "Show a study's definition: conditions, tasks, hypotheses with their tests, and its hash.",
        ),
        "study run": _ours(
            "study:run_study",
            "Send simulated people through a study, analyse their trials, and write the report.",
        ),
        "study power": _ours(
            "study:power_of_study",
            "Find how many people a study needs: studies drawn from simulated people,"
            " through its own analysis.",
        ),
        "study preregister": _ours(
            "study:preregister_study",
            "Write a study's plan with its hypotheses, analysis and power into one document with a hash.",
        ),
        "study questions": _ours(
            "study_answers:questions",
            "Write a study's questionnaire: after each condition all items, in a random order"
            " for each person.",
        ),
        "study serve": _ours(
            "study_serve:serve_study",
            "Take real people through a study on the page: consent, practice, trials, questions, completion"
            " code.",
        ),
        "study progress": _ours(
            "study_progress:progress_of_study",
            "Show how far the people of a served study have come, also while it is served.",
        ),
        "study export": _ours(
            "study_data:export_study",
            "Write a study as a Psych-DS dataset, with scripts in Python and R for the tables of its report.",
        ),
        "study replay": _ours(
            "study_data:replay_study",
            "Measure all drives of a served study again, from the steps that were kept of them.",
        ),
        "study delete": _ours(
            "study_data:delete_people", "Delete people from a served study with all that is kept of them."
        ),
        "study analyse": _ours(
            "study_answers:analyse_study",
            "Analyse recorded trials, with the answers of real people, and write the report.",
        ),
        "bench": _ours(
            "bench:bench",
            "Time the online step, and training ten seeds in one fit and one after the other.",
        ),
    },
    {
        "reproduce": "Reproduce a study of the paper; `reproduce --help` lists them.",
        "measure": "Measure what is behind a figure of the documentation; `measure --help` lists them.",
        "study": "Send simulated or real people through user studies; `study --help` lists how.",
    },
)
