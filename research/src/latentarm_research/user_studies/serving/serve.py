"""Serves a study from its folder, from the training of its models to Ctrl-C."""

from collections.abc import Callable
from contextlib import ExitStack
from socket import gethostname
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.demonstrations.folders import locked
from latentarm.runs.results_folder import write_json
from latentarm.web.server.app import serve_gate
from latentarm.web.server.config import check_certificate, listen
from latentarm.web.server.security import Gate
from latentarm_research.studies.results_folder import ResultsFolder, write_options
from latentarm_research.user_studies.recorded import DATABASE, DEFINITION, SERVED
from latentarm_research.user_studies.serving.app import StudyServer
from latentarm_research.user_studies.serving.kept_options import information_path
from latentarm_research.user_studies.serving.links import SITE_IDS
from latentarm_research.user_studies.serving.models import MODELS, Models
from latentarm_research.user_studies.serving.options import Serving
from latentarm_research.user_studies.serving.page_drive import check_served
from latentarm_research.user_studies.serving.participant_pages import HOME
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.study_files import LINKS, check_links, write_links

_LOCK: Final = ".serve.lock"


def serve(serving: Serving, say: Callable[[str], None], ready: Callable[[str], None]) -> None:
    """Serve until Ctrl-C. ``say`` prints a line; ``ready`` is called once with a participant's link.

    Raises a `UserError` where the page cannot offer a condition, or the folder or the database holds
    something else, which it leaves as it is.
    """
    definition, config, kept = serving.definition, serving.config, serving.kept
    out = serving.out
    check_served(definition)
    check_certificate(config)
    folder = ResultsFolder(definition.study, (), (DEFINITION, DATABASE, MODELS), (SERVED, "places"))
    about: dict[str, object] = {
        "study": folder.name,
        "definition": definition.digest,
        "people_are": "real",
        "preset": {"name": kept.preset},
        "seed": kept.seed,
        "places": definition.people,
        SERVED: kept.model_dump(),
    }
    folder.check(out, about)
    with ExitStack() as at_end:
        # All that may be refused comes before anything is written or trained.
        listening = at_end.enter_context(listen(config))
        try:
            out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UserError(f"{out} cannot be made: {error.strerror or error}.") from error
        at_end.enter_context(
            locked(out, out / _LOCK, "end it with Ctrl-C, or choose another folder with --out")
        )
        store = Store(serving.database, 3600.0 * kept.away_hours)
        at_end.callback(store.close)
        store.owner.check(kept.key)
        write_text(information_path(out, kept.information), serving.information)
        write_json(out / DEFINITION, {"digest": definition.digest, **definition.as_json()})
        write_options(out, about)
        store.owner.note(kept.key, definition.name)
        origins = config.origins(int(listening.getsockname()[1]))
        address = f"{origins[0]}{HOME}"
        codes = store.open_places(definition.people)
        check_links(out, codes)
        write_links(out, address, codes)
        models = Models(definition, out)
        for task in models.missing():
            say(f"Models for {task.label} are being trained; this takes minutes, once.")
            models.train(task, serving.sizes, kept.seed)
        servers = store.servers(f"{gethostname()}:{out.resolve()}", address, serving.at_once)
        app = StudyServer(serving, store, models, servers)
        hosts = frozenset(origin.split("//")[1] for origin in origins)
        gate = Gate(app, hosts, frozenset(origins), secure=config.encrypted, stop=app.stop)

        def open_it() -> None:
            unused = store.unused()
            link = address if unused is None else f"{address}?code={unused}"
            if unused is None:
                say("All links are in use.")
            else:
                say(f"A participant's link, which nobody has used: {link}")
            say(f"All {len(codes)} are in {out / LINKS}; each is for one person.")
            if kept.prolific is not None:
                ids = "&".join(f"{name}={{{{%{name}%}}}}" for name in SITE_IDS)
                say(f"For Prolific: {address}?{ids}")
            database = "" if kept.database is None else f" --database {kept.database}"
            say(f"The report, at any time: latentarm study analyse {out}{database}")
            say("End the study with Ctrl-C.")
            ready(link)

        serve_gate(gate, config, listening, open_it)
        say("The study is closed; the same command goes on with it.")
