"""The best of some draws: nearer to the truth than most of them, and by the seed alone."""

from dataclasses import replace

import numpy as np

from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.search.best_of_draws import STAGES, best_of_draws
from linear_data import SIZE, Linear, posterior


class Parts(Linear):
    """Linear data whose parts have larger errors, and which keep how many were simulated."""

    asked: list

    def on_some_lines(self, share, fewest, rng):
        part = replace(self, variance=self.variance / share)
        part.asked = self.asked
        self.asked.append([share, None])
        return part

    def simulate(self, X):
        self.asked[-1][1] = len(X)
        return super().simulate(X)


def test_fewer_and_fewer_draws_are_compared_on_more_and_more_data(linear):
    parts = Parts(**vars(linear))
    parts.asked = []
    about = Gaussian(np.zeros(SIZE), np.eye(SIZE))
    x = best_of_draws(parts, about, np.random.default_rng(1))
    assert [tuple(one) for one in parts.asked] == [(share, count) for count, share in STAGES]
    near = posterior(linear)
    others = about.draw(np.random.default_rng(2), 1000)
    assert near.squared_distance(x) < np.quantile(near.squared_distance(others), 0.05)


def test_draws_depend_on_the_seed_alone(linear):
    about = Gaussian(np.zeros(SIZE), np.eye(SIZE))
    one, same, other = (best_of_draws(linear, about, np.random.default_rng(k)) for k in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert (one != other).any()
