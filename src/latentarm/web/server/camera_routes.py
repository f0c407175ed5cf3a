"""The address at which a page asks for the cameras."""

import asyncio
from dataclasses import dataclass, field
from typing import Annotated, Final, final

from pydantic import Field
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from latentarm.web.cameras.process import CameraProcess
from latentarm.web.protocol.notice import Message, NoticeError
from latentarm.web.server.answers import body_of, json_answer
from latentarm.web.server.connected_pages import ConnectedPages
from latentarm.web.server.security import BODY_LIMIT

CAMERAS: Final = "/cameras"

_LOOK_S: Final = 0.25


class _Offer(Message):
    page: Annotated[str, Field(max_length=40)]
    sdp: Annotated[str, Field(max_length=BODY_LIMIT)]


@final
@dataclass(eq=False)
class CameraRoutes:
    """Shows pages the cameras while they are connected to `/drive`."""

    _cameras: CameraProcess
    _connected: ConnectedPages
    _looking: set[str] = field(default_factory=set[str], init=False)

    def routes(self) -> list[Route]:
        return [Route(CAMERAS, self._offer, methods=["POST"])]

    async def follow(self) -> None:
        """Drop the viewers of pages that have gone, until cancelled."""
        while True:
            for page in [one for one in self._looking if self._connected.named(one) is None]:
                self._looking.discard(page)
                self._cameras.leave(page)
            await asyncio.sleep(_LOOK_S)

    async def _offer(self, request: Request) -> Response:
        offer = await body_of(request, _Offer)
        if self._connected.named(offer.page) is None:
            raise NoticeError("request_invalid")
        self._looking.add(offer.page)
        return json_answer({"sdp": await self._cameras.answer(offer.page, offer.sdp)})
