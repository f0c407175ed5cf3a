"""Write the types of messages and records, for `tsc` to check the page's JavaScript with.

`make message-types` writes them; a test compares the file with what `message_types` returns. What each field
means is documented where the server declares it.
"""

import json
from pathlib import Path
from typing import Any, Final, final, get_args

from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from latentarm.web.protocol.learning_messages import LearningState
from latentarm.web.protocol.page_messages import ClientMessage
from latentarm.web.protocol.server_messages import Poses, Refused, State, Welcome
from latentarm.web.records.drive_record import DriveRecord, Trace
from latentarm.web.records.recordings import RecordingFile

TARGET: Final = Path(__file__).parents[1] / "src/latentarm/web/pages/connection/messages.d.ts"

_SERVER: Final = (Welcome, State, LearningState, Poses, Refused)
_RECORDS: Final = (DriveRecord, Trace, RecordingFile)
_PLAIN: Final = {
    "integer": "number",
    "number": "number",
    "string": "string",
    "boolean": "boolean",
    "null": "null",
}


@final
class _Sent(GenerateJsonSchema):
    """A schema in which the server leaves no field of its messages out."""

    def field_is_required(self, field: Any, total: bool) -> bool:
        return self.mode == "serialization" or super().field_is_required(field, total)


def message_types() -> str:
    """TypeScript declarations of every message and record, made from the schemas that pydantic derives."""
    client = tuple(_members(ClientMessage))
    _, schema = models_json_schema(
        [(model, "validation") for model in client]
        + [(model, "serialization") for model in (*_SERVER, *_RECORDS)],
        schema_generator=_Sent,
    )
    unions = {"ClientMessage": client, "ServerMessage": _SERVER}
    parts = ["// Written by `make message-types` from the messages that the server declares."]
    parts += [_interface(name, model) for name, model in schema["$defs"].items()]
    parts += [
        f"export type {name} = {' | '.join(model.__name__ for model in models)};"
        for name, models in unions.items()
    ]
    return "\n\n".join(parts) + "\n"


def _members(union: Any) -> list[Any]:
    """The models of a union, those of unions within it too."""
    inner = get_args(union)
    return [model for part in inner for model in _members(part)] if inner else [union]


def _interface(name: str, model: dict[str, Any]) -> str:
    required = model.get("required", [])
    fields = [
        f"  {field}{'' if field in required or 'const' in schema else '?'}: {_type(schema)};"
        for field, schema in model["properties"].items()
    ]
    return "\n".join([f"export interface {name} {{", *fields, "}"])


def _type(schema: dict[str, Any]) -> str:
    """A JSON schema, of the forms that our messages have, as a TypeScript type."""
    match schema:
        case {"$ref": path}:
            return path.rsplit("/", 1)[1]
        case {"const": value}:
            return json.dumps(value)
        case {"enum": values}:
            return " | ".join(json.dumps(value) for value in values)
        case {"anyOf": choices} | {"oneOf": choices}:
            return " | ".join(_type(choice) for choice in choices)
        case {"type": "array", "prefixItems": items}:
            return f"[{', '.join(_type(item) for item in items)}]"
        case {"type": "array", "items": item}:
            return f"({_type(item)})[]" if "anyOf" in item or "enum" in item else f"{_type(item)}[]"
        case {"type": "object", "additionalProperties": dict() as value}:
            return f"Record<string, {_type(value)}>"
        case _:
            return _PLAIN[schema["type"]]


if __name__ == "__main__":
    TARGET.write_text(message_types(), encoding="utf-8")
