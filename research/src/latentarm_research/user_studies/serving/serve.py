"""Serves a study from its folder, from the training of its models to Ctrl-C."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Final

from latentarm.core.files import write_text
from latentarm.demonstrations.folders import locked
from latentarm.runs.results_folder import write_json
from latentarm.web.server.app import serve_gate
from latentarm.web.server.config import check_certificate, listen
from latentarm.web.server.security import Gate
from latentarm_research.studies.results_folder import ResultsFolder
from latentarm_research.user_studies.recorded import DATABASE, DEFINITION
from latentarm_research.user_studies.serving.app import SITE_IDS, StudyServer
from latentarm_research.user_studies.serving.database import database_of
from latentarm_research.user_studies.serving.models import MODELS, Models
from latentarm_research.user_studies.serving.options import Serving
from latentarm_research.user_studies.serving.page_drive import check_served
from latentarm_research.user_studies.serving.participant_pages import HOME
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.study_files import LINKS, write_links

_LOCK: Final = ".serve.lock"


def serve(serving: Serving, say: Callable[[str], None], ready: Callable[[str], None]) -> None:
    """Serve until Ctrl-C. ``say`` prints a line; ``ready`` is called once with the first address.

    Raises a `UserError` where the page cannot offer a condition, or the folder holds something else.
    """
    definition, config = serving.definition, serving.config
    out = serving.out
    check_served(definition)
    check_certificate(config)
    folder = ResultsFolder(definition.study, (), (DATABASE, MODELS))
    folder.claim(
        out,
        {
            "study": folder.name,
            "definition": definition.digest,
            "people_are": "real",
            "preset": {"name": serving.sizes.name},
            "seed": serving.seed,
        },
    )
    write_json(out / DEFINITION, {"digest": definition.digest, **definition.as_json()})
    with ExitStack() as at_end:
        at_end.enter_context(
            locked(out, out / _LOCK, "end it with Ctrl-C, or choose another folder with --out")
        )
        models = Models(definition, out)
        for task in models.missing():
            say(f"Models for {task.label} are being trained; this takes minutes, once.")
            models.train(task, serving.sizes, serving.seed)
        listening = at_end.enter_context(listen(config))
        store = Store(database_of(out / DATABASE, serving.database), serving.away_s)
        at_end.callback(store.close)
        write_text(out / f"information-{serving.digest[:12]}.md", serving.information)
        origins = config.origins(int(listening.getsockname()[1]))
        app = StudyServer(serving, store, models)
        hosts = frozenset(origin.split("//")[1] for origin in origins)
        gate = Gate(app, hosts, frozenset(origins), secure=config.encrypted, stop=app.stop)

        def open_it() -> None:
            links = [f"{origins[0]}{HOME}?code={code}" for code in store.open_places(definition.people)]
            write_links(out, links)
            say(f"A participant's link: {links[0]}")
            say(f"All {len(links)} are in {out / LINKS}; each is for one person.")
            if serving.prolific is not None:
                ids = "&".join(f"{name}={{{{%{name}%}}}}" for name in SITE_IDS)
                say(f"For Prolific: {origins[0]}{HOME}?{ids}")
            say(f"The report, at any time: latentarm study analyse {out} (end the study with Ctrl-C).")
            ready(links[0])

        serve_gate(gate, config, listening, open_it)
        say("The study is closed; the same command goes on with it.")
