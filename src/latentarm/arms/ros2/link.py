"""A connection to rosbridge that opens once, and never waits once it is open."""

import importlib.util
import logging
import socket
from collections.abc import Callable, Mapping
from typing import Any, Final, final

from latentarm.core.errors import UserError

CONNECTING_S: Final = 3.0  # for rosbridge to answer


def check_installed(what: str = "--arm ros2") -> None:
    """Check that roslibpy is installed, which ``what`` needs."""
    if importlib.util.find_spec("roslibpy") is None:
        raise UserError(f"{what} needs roslibpy: pip install 'latentarm[ros2]'.")


@final
class Link:
    """A connection to rosbridge, in a thread of roslibpy, which also runs callbacks.

    It never reopens by itself: roslibpy would then send delayed messages. A new link replaces a lost one.
    """

    def __init__(self, host: str, port: int) -> None:
        import roslibpy
        from roslibpy.core import RosTimeoutError

        # It warns that it does not open a lost link again, which it was told not to.
        logging.getLogger("roslibpy").setLevel(logging.ERROR)
        self._lib: Any = roslibpy
        self._topics: dict[str, Any] = {}
        self._actions: dict[str, Any] = {}
        try:
            socket.create_connection((host, port), CONNECTING_S).close()
        except OSError as error:
            raise UserError(
                f"Nothing answers at {host}:{port}: check the cable and the address, and start"
                " rosbridge there (ros2 launch rosbridge_server rosbridge_websocket_launch.xml"
                " send_action_goals_in_new_thread:=true)."
            ) from error
        self._ros: Any = roslibpy.Ros(host, port, transport="asyncio")
        self._ros.factory.maxRetries = 0
        try:
            self._ros.run(CONNECTING_S)
        except RosTimeoutError as error:
            raise UserError(
                f"What answers at {host}:{port} is not rosbridge: check host and port."
            ) from error

    @property
    def connected(self) -> bool:
        """Whether the connection stands, as far as this side knows."""
        return bool(self._ros.is_connected)

    def advertise(self, topic: str, kind: str) -> None:
        """Announce messages of a type on a topic."""
        self._topics[topic] = self._lib.Topic(self._ros, topic, kind, reconnect_on_close=False)
        self._topics[topic].advertise()

    def publish(self, topic: str, message: Mapping[str, Any]) -> None:
        """Send a message on an advertised topic; without a connection nothing is sent."""
        if self.connected:
            self._topics[topic].publish(message)

    def subscribe(self, topic: str, kind: str, heard: Callable[[Mapping[str, Any]], None]) -> None:
        """Take the messages of a topic; the newest replaces the rest."""
        self._topics[topic] = self._lib.Topic(
            self._ros, topic, kind, queue_length=1, reconnect_on_close=False
        )
        self._topics[topic].subscribe(heard)

    def unsubscribe(self, topic: str) -> None:
        """Take the messages of a topic no more."""
        subscribed = self._topics.pop(topic)
        if self.connected:
            subscribed.unsubscribe()

    def call(self, service: str, kind: str, timeout_s: float) -> Mapping[str, Any] | None:
        """Call a service without arguments; its answer, or None in case of a time-out."""
        from roslibpy.core import RosTimeoutError, ServiceException

        try:
            asked = self._lib.Service(self._ros, service, kind)
            return dict(asked.call(self._lib.ServiceRequest(), timeout=timeout_s))
        except (RosTimeoutError, ServiceException):
            return None

    def send_goal(
        self,
        action: str,
        kind: str,
        goal: Mapping[str, Any],
        succeeded: Callable[[Mapping[str, Any]], None],
        failed: Callable[[Mapping[str, Any]], None],
    ) -> str | None:
        """Send a goal to an action server; its id, or None without a connection."""
        if not self.connected:
            return None
        if action not in self._actions:
            self._actions[action] = self._lib.ActionClient(self._ros, action, kind)
        client = self._actions[action]
        sent = client.send_goal(self._lib.Goal(goal), succeeded, _ignore, failed)
        client.wait_results.pop(sent, None)
        return str(sent)

    def cancel_goal(self, action: str, goal: str) -> None:
        """Ask an action server to give up a goal."""
        if self.connected and action in self._actions:
            self._actions[action].cancel_goal(goal)

    def close(self) -> None:
        """End the connection, without waiting for the other side."""
        if self.connected:
            self._ros.close()


def _ignore(_: object) -> None:
    """Feedback of an action adds nothing to the joint states."""
