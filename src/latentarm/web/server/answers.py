"""Requests about records: JSON objects with known fields. Errors are answered as notices."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Final, TypeVar, cast

from pydantic import BaseModel, ValidationError
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import parse_object
from latentarm.web.protocol.notice import NoticeError, notice_of

NO_STORE: Final = {"cache-control": "no-store"}  # header of answers with personal data

_STATUS: Final = {
    "person_unknown": 404,
    "record_unknown": 404,
    "pin_needed": 403,
    "pin_wait": 429,
    "pin_wrong": 403,
}

Answer = Callable[[Request], Awaitable[Response]]
Asked = TypeVar("Asked", bound=BaseModel)


def routes_of(answers: Mapping[str, Mapping[str, Answer]]) -> list[Route]:
    """Routes from handlers by path and method."""
    return [
        Route(path, answer, methods=[method])
        for path, methods in answers.items()
        for method, answer in methods.items()
    ]


def refused(_: Request, error: Exception) -> Response:
    """The answer to a request that failed with a `UserError`, as a notice."""
    notice = notice_of(cast(UserError, error))
    return json_answer({"notice": notice.model_dump()}, _STATUS.get(notice.code, 400))


def json_answer(content: object, status: int = 200) -> Response:
    """An answer that no cache keeps."""
    return JSONResponse(content, status, headers=NO_STORE)


async def body_of(request: Request, kind: type[Asked]) -> Asked:
    """A request's body, validated. Raises NoticeError if the body is invalid."""
    body = await request.body()
    try:
        parse_object(body, "The request")
        return kind.model_validate_json(body)
    except (UserError, ValidationError) as error:
        raise NoticeError("request_invalid") from error
