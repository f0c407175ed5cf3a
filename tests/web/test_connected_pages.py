"""At most one page drives, and nobody begins or stops driving without a word."""

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from latentarm.web.server.connected_pages import MOST, ConnectedPages


def test_the_first_page_drives_and_the_next_watches():
    connected = ConnectedPages()
    ada, bob = connected.join("Ada"), connected.join("Bob")
    assert connected.drives(ada)
    assert not connected.drives(bob)
    assert connected.driver.name == "Ada"


def test_driving_is_handed_over_only_to_who_asked():
    connected = ConnectedPages()
    ada, bob, eve = (connected.join(name) for name in ("Ada", "Bob", "Eve"))
    assert not connected.hand_over(ada, bob.id)
    connected.ask(bob)
    connected.ask(eve)
    assert connected.asking == bob
    assert not connected.hand_over(bob, bob.id)
    assert not connected.hand_over(ada, eve.id)
    assert connected.hand_over(ada, bob.id)
    assert connected.drives(bob)
    assert connected.asking is None


def test_a_driver_who_goes_leaves_the_arm_to_who_asked_or_to_nobody():
    connected = ConnectedPages()
    ada, bob = connected.join("Ada"), connected.join("Bob")
    assert connected.leave(ada)
    assert connected.driver is None
    connected.ask(bob)
    assert connected.drives(bob)
    eve = connected.join("Eve")
    connected.ask(eve)
    assert connected.release(bob)
    assert connected.drives(eve)


def test_there_is_room_for_so_many():
    connected = ConnectedPages()
    pages = [connected.join(None) for _ in range(MOST)]
    assert connected.join("one too many") is None
    assert len({page.id for page in pages}) == MOST
    connected.leave(pages[3])
    assert connected.join("now") is not None


class Handovers(RuleBasedStateMachine):
    """Pages come, ask, hand over, give up and go in any order."""

    def __init__(self):
        super().__init__()
        self.connected = ConnectedPages()
        self.pages = []
        self.turn = self.connected.turn
        self.driver = None

    @rule()
    def come(self):
        page = self.connected.join("somebody")
        if page is not None:
            self.pages.append(page)

    @rule(at=st.integers(0, 20), what=st.sampled_from(["ask", "release", "leave"]))
    def do(self, at, what):
        if self.pages:
            page = self.pages[at % len(self.pages)]
            getattr(self.connected, what)(page)
            if what == "leave":
                self.pages.remove(page)

    @rule(giver=st.integers(0, 20), taker=st.integers(0, 20))
    def hand_over(self, giver, taker):
        if self.pages:
            self.connected.hand_over(
                self.pages[giver % len(self.pages)], self.pages[taker % len(self.pages)].id
            )

    @invariant()
    def one_drives_at_most_and_every_change_is_a_new_turn(self):
        driving = [page for page in self.pages if self.connected.drives(page)]
        assert len(driving) <= 1
        assert self.connected.driver == (driving[0] if driving else None)
        assert self.connected.asking not in driving or self.connected.asking is None
        if self.connected.driver != self.driver:
            assert self.connected.turn > self.turn
        self.driver, self.turn = self.connected.driver, self.connected.turn
        assert self.connected.count == len(self.pages)


TestHandovers = Handovers.TestCase


def test_guests_are_numbered_from_1_among_those_who_are_there():
    connected = ConnectedPages()
    first, second = connected.join(None), connected.join("")
    assert (first.name, second.name) == (1, 2)
    connected.release(first)
    connected.ask(second)
    connected.leave(first)
    assert [connected.join(None).name for _ in range(2)] == [1, 3]
