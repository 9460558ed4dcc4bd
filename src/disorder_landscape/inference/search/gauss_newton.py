"""The last micro-electronvolts: Gauss–Newton steps to the optimum of the posterior, and its width.

The width is that of Laplace's approximation. The derivatives are exact where the closed form has
them, at a cost that does not depend on the number of unknowns. Elsewhere they are central
differences of the thermal averages. The differences are no less than is needed for the simulation's
own error (of few conductances up to 10⁻⁴ e²/h) not to pass for a slope.

Slopes over longer distances lead nowhere: with those over half a standard deviation of a network's
guess, steps stopped 10 to 100 µeV off. With the exact ones they find the optimum from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.inference.optimum import Optimum, chi_square_excess, is_noise
from disorder_landscape.inference.problem.gaussian import Gaussian
from disorder_landscape.inference.problem.observation import Observation, objective, overall_misfit
from disorder_landscape.inference.stages import Report, no_report
from disorder_landscape.model.parameters import FloatArray

DIFFERENCE = 1e-4
"""Step of the differences in meV per site, root mean square, or what changes the conductances as
much: a fortieth of kT at 50 mK. (Five times as much changes error bars by a few percent, and so,
now and then, does a fifth of it.)"""


class Accuracy(NamedTuple):
    """How exact derivatives are."""

    doubt: float
    """Where those of the closed form are trusted less than this, differences replace them."""
    roughly: bool = False
    """Whether rough ones do."""


AT_OPTIMUM, NEAR_ONE = Accuracy(1.0), Accuracy(30.0)
"""Where steps go to an optimum itself, and where they go near one. (The estimated errors are large:
of nineteen sets of wires of 300 sites that had to be within 0.003 and were not, derivatives were
off by 0.0005 on average and 0.003 at most. Differences in these sets take three quarters of the
time.)"""
IN_SMALL_STEPS = NEAR_ONE._replace(roughly=True)
"""Where they are small."""
STEPS = 30
"""At most, …"""
FEW_STEPS = 3
"""… or where few are asked for. (With so many for a draw of data, instead of as many as lead to an
optimum, first ways to the whole landscape of six wires ended 0, 3, 0, 0, 83 and 14 above the
truth's optimum in −2 log(posterior), instead of 0, 18, 16, 0, 83 and 94, in 1.1 times the time.)"""
DAMPING = 4.0, 1e-2, 1e6
"""Factor, first and largest value of Levenberg's and Marquardt's damping."""
ENOUGH = 0.3
"""Steps end when one lowers −2 log(posterior) by less than this, which is half a standard deviation
of all unknowns together. The simulation's own error adds about as much at a noise of 0.01 e²/h."""
ROUGHLY = 3.0
"""… or by less than this, where not the optimum itself is asked for."""
CREEPING, LATELY = 0.5, 4
"""Steps that creep end, too, where an optimum's place is asked for: if the noise does not explain
the misfit, and −2 log(posterior) less the number of data, which is about what noise alone makes, is
more than this part of what it was so many steps ago. (Steps that arrive halve it in one or two.)"""
NEAR = 1.5
"""Steps end at a known optimum if they come this near: by so much −2 log(posterior) would be higher
if data were linear."""

Goal = Literal["optimum", "place", "better", "few"]
"""Where steps end: at an optimum, near one (as ROUGHLY and CREEPING say), near one, creeping or
not, or there after few steps, too."""


def gauss_newton(
    observation: Observation,
    start: FloatArray,
    progress: Report = no_report,
    known: Sequence[Optimum] = (),
    goal: Goal = "optimum",
) -> Gaussian:
    """Return the local optimum that damped Gauss–Newton steps lead to, with Laplace's covariance.

    Parameters
    ----------
    observation : Observation
    start : array, shape (unknown,)
    progress : callable
        Called before each step, with its number, the root-mean-square misfit in e²/h and the
        standard deviation of V in meV.
    known : sequence of Optimum
        Steps that come near one of these, and not below it, end there.
    goal : "optimum", "place", "better" or "few"
        The covariance is that with the slopes before the last step, which at an optimum is as good.
    """
    prior, variance = observation.unknowns.white_noise, observation.variance
    precision = np.linalg.inv(prior.covariance)
    x, (factor, first, largest) = start, DAMPING
    roughly, most = goal != "optimum", FEW_STEPS if goal == "few" else STEPS
    accuracy = NEAR_ONE if roughly else AT_OPTIMUM
    y, slope = linearise(observation, start, accuracy)
    best, damping = float(objective(observation, x, y)), 0.0
    heights = [best]
    for number in range(most):
        information = precision_of(observation, slope)
        spread = observation.unknowns.site_std(np.asarray(np.linalg.inv(information), np.float64))
        progress(number, overall_misfit(observation, y), spread)
        downhill = (slope / variance) @ (observation.data - y) - precision @ (x - prior.mean)
        while True:
            damped = information + damping * np.diag(np.diag(information))
            tried = x + np.linalg.solve(damped, downhill)
            y_tried, found = _simulated(observation, tried)
            if found < best or damping > largest:
                break
            damping = max(first, factor**2 * damping)
        step = tried - x
        while found < best:  # a valley that bends: a line search costs next to nothing
            further = tried + step
            y_further, found_further = _simulated(observation, further)
            if found_further >= found:
                break
            tried, y_tried, found, step = further, y_further, found_further, 2 * step
        gained = best - found
        if gained > 0:
            x, y, best = tried, y_tried, found
        heights.append(best)
        if gained < (ROUGHLY if roughly else ENOUGH):
            break
        if goal == "place" and _creep(observation, heights, y):
            break
        for one in known:
            if best > one.objective and is_near(one, x):
                return one.answer
        if goal == "few" and number + 1 == most:
            break  # its width is not asked for
        slope = linearise(observation, x, accuracy)[1]
        damping = 0.0 if damping <= first else damping / factor
    return laplace(observation, x, slope)


def _simulated(observation: Observation, x: FloatArray) -> tuple[FloatArray, float]:
    """Return data of x (unknown,), and −2 log(posterior): infinite where V is too large for any."""
    try:
        y = observation.simulate(x[None])[0]
    except ArgumentError:
        return observation.data, np.inf
    return y, float(objective(observation, x, y))


def _creep(observation: Observation, heights: Sequence[float], y: FloatArray) -> bool:
    """Return whether steps through these values of −2 log(posterior), to data y, lead nowhere."""
    if len(heights) <= LATELY or is_noise(chi_square_excess(observation, y)):
        return False
    return heights[-1] - y.size > CREEPING * (heights[-1 - LATELY] - y.size)


def is_near(optimum: Optimum, x: FloatArray) -> bool:
    """Return whether steps at x (unknown,) may end at this optimum."""
    return bool(optimum.answer.squared_distance(x) < NEAR)


def laplace(observation: Observation, mean: FloatArray, slope: FloatArray) -> Gaussian:
    """Return Laplace's approximation: the posterior about an optimum if data were linear."""
    covariance = np.linalg.inv(precision_of(observation, slope))
    return Gaussian(mean, (covariance + covariance.T) / 2)


def precision_of(observation: Observation, slope: FloatArray) -> FloatArray:
    """Return the inverse covariance of the posterior if data were linear (unknown, unknown)."""
    prior = np.linalg.inv(observation.unknowns.white_noise.covariance)
    return np.asarray((slope / observation.variance) @ slope.T + prior)


def linearise(
    observation: Observation, x: FloatArray, accuracy: Accuracy = AT_OPTIMUM
) -> tuple[FloatArray, FloatArray]:
    """Return the data of x (unknown,), shape (datum,), and their slopes (unknown, datum)."""
    found = observation.closed_form_slopes(x, accuracy.roughly)
    if found is None:
        return _differences(observation, x)
    y, slope = found.data, found.slope
    for mu, B in np.argwhere(found.doubt > accuracy.doubt):
        of_set, at = observation.of_set(mu, B)
        if at.size:
            y[at], slope[:, at] = _differences(of_set, x)
    return y, slope


def _differences(observation: Observation, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Do as `linearise`, by central differences."""
    step = DIFFERENCE * observation.unknowns.alike
    Y = observation.simulate(np.concatenate([[x], x + np.diag(step), x - np.diag(step)]))
    up, down = np.split(Y[1:], 2)
    return Y[0], (up - down) / (2 * step[:, None])
