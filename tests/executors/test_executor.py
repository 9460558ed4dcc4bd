"""Shares: together they are all tasks, and each is one once."""

from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as some

from disorder_landscape import ArgumentError
from disorder_landscape.executors.executor import WHOLE, Share, parse_share


@given(some.integers(0, 50), some.integers(1, 12))
def test_shares_are_all_tasks_together_each_once(tasks, count):
    shares = [list(Share(number, count).of(range(tasks))) for number in range(1, count + 1)]
    assert sorted(chain.from_iterable(shares)) == list(range(tasks))
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


def test_a_share_is_read():
    assert parse_share("3/8") == Share(3, 8)
    assert parse_share("1/1") == WHOLE


@pytest.mark.parametrize(
    "text", ["", "3", "0/8", "9/8", "-1/8", "1/0", "3/8/2", "a/b", "1/9999999999"]
)
def test_what_is_no_share_is_refused(text):
    with pytest.raises(ArgumentError, match="share must be like 3/8"):
        parse_share(text)
