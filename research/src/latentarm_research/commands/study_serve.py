"""`latentarm study serve`: a study with real people, on the page."""

import json as json_format
import os
from functools import partial
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.output import say
from latentarm.core.errors import UserError
from latentarm.runs.options import Json
from latentarm_research.commands.study_options import Database, StudyName
from latentarm_research.user_studies.own.definition_file import find_definition
from latentarm_research.user_studies.sizes import PRESETS


def serve_study(
    name: Positional[StudyName],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder of the study; by default studies/NAME-people.")
    ] = None,
    host: Annotated[str, arg(help="The address to serve.")] = "127.0.0.1",
    port: Annotated[int, arg(help="Port; 0 takes any free one.")] = 8461,
    certfile: Annotated[Path | None, arg(metavar="PEM", help="Certificate for TLS.")] = None,
    keyfile: Annotated[Path | None, arg(metavar="PEM", help="Its private key.")] = None,
    public_url: Annotated[
        str | None,
        arg(
            metavar="URL",
            help="The address that people open where a proxy serves the page; see docs/deploy.md.",
        ),
    ] = None,
    contact: Annotated[
        str | None,
        arg(metavar="TEXT", help="Whom participants can ask; every page says it. The first start needs it."),
    ] = None,
    language: Annotated[
        str | None,
        arg(metavar="CODE", help="Language of the study's own pages: de, es, zh or, by default, en."),
    ] = None,
    information: Annotated[
        Path | None,
        arg(metavar="FILE", help="Markdown that people read and consent to; without it, a general text."),
    ] = None,
    prolific: Annotated[
        str | None,
        arg(metavar="STUDY_ID", help="Let participants of this study at Prolific in by its links too."),
    ] = None,
    completion_code: Annotated[
        str | None,
        arg(metavar="CODE", help="What everybody gets at the end; without it, a code of their own."),
    ] = None,
    at_once: Annotated[
        int | None,
        arg(metavar="N", help="How many people may drive at the same time; by default one per processor."),
    ] = None,
    away_hours: Annotated[
        float | None,
        arg(metavar="H", help="Who is away for longer loses the place to the next; by default 2."),
    ] = None,
    database: Database = None,
    preset: Annotated[
        str | None,
        arg(
            metavar="{" + ",".join(PRESETS) + "}",
            help="smoke: one trial of a second at each task; by default paper.",
        ),
    ] = None,
    seed: Annotated[int | None, arg(help="Seed of all randomness; by default 0.")] = None,
    json: Json = False,
) -> int:
    """Take real people through a study on the page: consent, practice, trials, questions, completion code.

    Prints the links for participants; Ctrl-C ends it, and the same command goes on with it. The folder keeps
    --contact, --language, --information, --prolific, --completion-code, --away-hours, --database, --preset
    and --seed of the first start. A later start may leave them out, except for the database's password; one
    that names others is refused. Servers with one PostgreSQL database share the people.

    For example: latentarm study serve eating --contact "Ann Lee, ann@uni.example"
    """
    from latentarm.web.arm_process.drive_setup import Spec
    from latentarm.web.server.config import TeleopConfig
    from latentarm_research.user_studies.recorded import DATABASE
    from latentarm_research.user_studies.serving.database import database_of, postgresql, shown
    from latentarm_research.user_studies.serving.kept_options import (
        AWAY_HOURS,
        LANGUAGE,
        digest_of,
        go_on,
        information_path,
        read_information,
        read_kept,
    )
    from latentarm_research.user_studies.serving.options import Serving, general_information
    from latentarm_research.user_studies.serving.serve import serve
    from latentarm_research.user_studies.serving.words.catalogue import study_languages

    definition = find_definition(name)
    if preset is not None and preset not in PRESETS:
        raise UserError(f"There is no preset {preset!r}: choose from {', '.join(PRESETS)}.")
    if away_hours is not None and not 0.0 < away_hours <= 24 * 365:
        raise UserError(f"--away-hours must be above 0 and at most a year, not {away_hours:g}.")
    if at_once is not None and at_once < 1:
        raise UserError(f"--at-once must be 1 or more, not {at_once}.")
    if language is not None and language not in study_languages():
        raise UserError(f"There is no language {language!r}: choose from {', '.join(study_languages())}.")
    folder = Path("studies", f"{definition.name}-people") if out is None else out
    earlier = read_kept(folder)
    if information is not None:
        text = read_information(information)
    elif earlier is not None:
        text = read_information(information_path(folder, earlier.information))
    else:
        words = study_languages()[LANGUAGE if language is None else language]
        text = general_information(definition, AWAY_HOURS if away_hours is None else away_hours, words)
    given = {
        "contact": contact,
        "language": language,
        "information": digest_of(text),
        "prolific": prolific,
        "completion_code": completion_code,
        "away_hours": away_hours,
        "database": None if database is None else shown(postgresql(database)),
        "preset": preset,
        "seed": seed,
    }
    kept = go_on(folder, earlier, given, partial(say, json=json))
    serving = Serving(
        definition,
        kept,
        TeleopConfig(Spec(out=folder), host, port, certfile, keyfile, public_url=public_url),
        text,
        at_once or os.cpu_count() or 1,
        database_of(folder / DATABASE, database or kept.database),
    )

    def ready(address: str) -> None:
        if json:
            print(json_format.dumps({"address": address}), flush=True)

    serve(serving, partial(say, json=json), ready)
    return 0
