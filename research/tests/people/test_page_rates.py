"""Through the page a person sees frames, not the arm, and their hand is heard now and then."""

import re
from importlib.resources import files

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.types import Context, Input, Pose
from latentarm.web.server.drive_socket import DRIVER_PERIOD_S
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.contract import Moment
from latentarm_research.people.page_rates import PAGE, SLOW, PageRates, Screen, Wire

PERIOD_S = 0.01
RATES = st.builds(
    PageRates,
    input_s=st.floats(0.005, 0.1),
    state_s=st.floats(0.005, 0.1),
    frame_s=st.floats(0.005, 0.05),
    network_s=st.floats(0.0, 0.05),
)


def moment(number):
    return Moment(
        Context(np.array([float(number)]), np.zeros(0)), 0, Pose(np.zeros(3), np.eye(3)), np.zeros(2)
    )


def shown(rates, calls):
    screen = Screen(rates, PERIOD_S)
    return np.array([screen.shown(moment(number)).context.state[0] for number in range(calls)])


def test_the_rates_are_the_pages_own():
    script = (files("latentarm.web") / "pages" / "inputs" / "drive_input.js").read_text(encoding="utf-8")
    assert 1000.0 * PAGE.input_s == float(re.search(r"const PERIOD_MS = (\d+);", script)[1])
    assert PAGE.state_s == DRIVER_PERIOD_S


def test_newcomers_go_as_fast_as_the_page_lets_a_new_person():
    script = (files("latentarm.web") / "pages" / "settings" / "settings.js").read_text(encoding="utf-8")
    assert float(re.search(r"sensitivity: within\(([\d.]+),", script)[1]) == SLOW
    assert PEOPLE["reading"].speed.share == PEOPLE["learning"].speed.share == SLOW


@settings(max_examples=40)
@given(RATES)
def test_what_is_on_the_screen_is_never_older_than_a_state_a_frame_and_the_network(rates):
    late_s = (np.arange(100) - shown(rates, 100)) * PERIOD_S
    assert late_s.min() >= 0.0
    assert late_s.max() <= rates.network_s + rates.state_s + rates.frame_s + PERIOD_S + 1e-9


def test_the_screen_goes_forward_in_frames():
    assert shown(PageRates(state_s=0.02, frame_s=0.02, network_s=0.0), 6).tolist() == [0, 0, 2, 2, 4, 4]
    assert shown(PageRates(state_s=0.02, frame_s=0.02, network_s=0.001), 6).tolist() == [0, 0, 0, 0, 2, 2]


def test_a_deflection_is_sent_now_and_then_and_at_once_where_it_begins_or_ends():
    wire = Wire(PageRates(input_s=0.03, network_s=0.0), PERIOD_S)
    pushed = [0.0, 0.1, 0.2, 0.3, 0.4, 0.0, 0.0]
    assert [wire.carried(Input(np.array([u]))).u[0] for u in pushed] == [0.0, 0.1, 0.1, 0.3, 0.3, 0.0, 0.0]


@settings(max_examples=40)
@given(RATES, st.lists(st.booleans(), min_size=1, max_size=20))
def test_every_mode_switch_arrives_once_and_in_time(rates, asked):
    wire = Wire(rates, PERIOD_S)
    asked = [*asked, *[False] * 6]
    arrived = [wire.carried(Input(np.zeros(1), switch_mode=one)).switch_mode for one in asked]
    late = int(np.ceil(rates.network_s / PERIOD_S - 1e-6))
    assert arrived == [*[False] * late, *asked][: len(asked)]
