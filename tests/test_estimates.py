import pytest

from disorder_landscape import estimates
from disorder_landscape.estimates import Pace, announce, announce_repeated, duration


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (40.4, "40 seconds"),
        (89.0, "89 seconds"),
        (100.0, "2 minutes"),
        (3599.0, "60 minutes"),
        (9000.0, "2.5 hours"),
    ],
)
def test_durations_are_said_in_one_unit(seconds, said):
    assert duration(seconds) == said


def test_what_is_soon_over_is_not_announced():
    said = []
    announce("generate", 4.9, said.append)
    assert not said
    announce("generate", 300.0, said.append)
    assert said == ["generate: about 5 minutes on this machine"]


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands still until it is moved."""
    now = [100.0]
    monkeypatch.setattr(estimates.time, "perf_counter", lambda: now[0])
    return now


def test_a_pace_tells_from_the_steps_after_the_warm_up(clock):
    said = []
    pace = Pace("train", 1000, said.append)
    for seconds in (20.0, 5.0, 0.25, 0.25, 0.25):
        clock[0] += seconds
        pace.step(10)
        assert not said
    for _ in range(3):
        clock[0] += 0.25
        pace.step(10)
    assert said == ["train: about 25 seconds on this machine"]


@pytest.mark.parametrize(
    ("times", "said", "done"),
    [(600, ["generate: about 3 minutes on this machine"], [0, 1, 2, 3, 4]), (0.5, [], [0])],
)
def test_what_is_repeated_takes_the_mean_time_of_a_second(clock, times, said, done):
    """… after the first, which loads what the others need."""
    lasts, heard, seen = [9.0, 0.3, 0.1, 0.2, 0.6, 9.0], [], []

    def action(k):
        seen.append(k)
        clock[0] += lasts[k]

    announce_repeated("generate", action, times, heard.append)
    assert (heard, seen) == (said, done)


def test_a_pace_of_several_at_a_time_waits_for_as_many(clock):
    said = []
    pace = Pace("study", 24, said.append, warm_up=0, at_a_time=2)
    clock[0] += 274.0
    pace.step()
    assert not said
    clock[0] += 6.0
    pace.step()
    assert said == ["study: about 56 minutes on this machine"]
