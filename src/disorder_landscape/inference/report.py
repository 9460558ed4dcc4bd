"""What `landscape infer` reads from its options, and the lines that it prints."""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.arguments import numbers_of
from disorder_landscape.config import TrainingConfig
from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.optimum import TOLERATED
from disorder_landscape.inference.problem.distributions import Distribution, Uniform
from disorder_landscape.inference.problem.observation import noise_of_channels, one_or_each
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.result import OPEN
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED, NOT_DESCRIBED
from disorder_landscape.model.parameters import NOISE_FLOOR, FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES

UNTRAINED = 2.0
"""A network guesses badly if errors are more than so many times those of its training."""
ALIKE = 1.1
"""Misfits are those of noise if they differ by less than this factor between the channels, …"""
OTHERWISE = 1.25
"""… and that noise is not the stated one if they are more or less than it by this factor."""

SURE = 0.95
"""What at least this share of the samples has is taken for sure."""

NOT_TO_BE_TRUSTED = "so neither error bars nor P(topological) are to be trusted"


def parse_noise(text: str) -> float | dict[str, float]:
    """Return the noise that "0.01" or "0.01,0.01,0.001,0.001" describes.

    Raises
    ------
    ArgumentError
        If the text is something else.
    """
    must = f"be a number in e²/h, or one for each of {', '.join(CONDUCTANCES)}"
    values = numbers_of("noise", text, (1, len(CONDUCTANCES)), must)
    return one_or_each(values)


def noise_hint(training: TrainingConfig, noise: float | dict[str, float]) -> str:
    """Return a line about a network that was trained with smaller errors only, or nothing."""
    most, known = noise_of_channels(noise).max(), training.largest_noise
    if training.noise_up_to is not None or most <= UNTRAINED * max(known, NOISE_FLOOR):
        return ""
    return (
        f"This network was trained with errors of up to {known:g} e²/h: for {most:g} e²/h one of "
        "the models named ..._noisy guesses better, and the inversion takes less time."
    )


def stated_noise_hint(misfit: FloatArray, noise: FloatArray, excess: float) -> str:
    """Return a line about noise that is other than stated; empty without any sign of that.

    What a model lacks makes some channels worse than others; noise makes all alike. Unknowns that
    are about as many as the data explain them whatever the noise is.

    Parameters
    ----------
    misfit, noise : array, shape (channel,)
        In e²/h; NaN where nothing was measured.
    excess : float
        Of χ² above its mean, in its standard deviations.
    """
    there = np.isfinite(misfit) & (noise > 0)
    times = misfit[there] / noise[there]
    if times.size == 0 or times.max() > ALIKE * times.min() or abs(excess) < TOLERATED:
        return ""
    if 1 / OTHERWISE < times.mean() < OTHERWISE or (times.size == 1 and times.mean() > 1):
        return ""
    other = "larger" if times.mean() > 1 else "smaller, and so the error bars"
    return (
        f"The misfit is {times.mean():.2g} times the noise in all channels alike: the noise "
        f"may be other than was stated: {other}."
    )


def parameter_with_std(result: xr.Dataset, name: str) -> str:
    """Return an unknown parameter and its standard deviation as text."""
    mean, std = float(result[f"{name}_mean"]), float(result[f"{name}_std"])
    digits = max(0, int(1 - np.floor(np.log10(std)))) if std > 0 else 6
    unit = result[name].attrs["units"]
    return f"{mean:.{digits}f} ± {std:.{digits}f}" + ("" if unit == "1" else f" {unit}")


def prior_as_text(belief: Distribution) -> str:
    """Return what was known of a parameter as text."""
    if isinstance(belief, Uniform):
        return f"{belief.low:g} to {belief.high:g}"
    return f"{belief.mean:g} ± {belief.std:g}"


def plain(number: float) -> str:
    """Return a number with two digits, and no exponent where it is neither large nor small."""
    return f"{float(f'{number:.2g}'):g}"


def _prior_bar(result: xr.Dataset) -> float:
    """Return the prior's standard deviation of V in meV, root mean square over the sites."""
    unknowns = Unknowns(prior_of_result(result))
    return unknowns.site_std(unknowns.prior.covariance)


def has_dissipation(result: xr.Dataset) -> bool:
    """Return whether the wire of a result has dissipation, or may have it."""
    return "dissipation" in result or bool(result.attrs.get("dissipation", 0.0))


def error_bar(result: xr.Dataset) -> float:
    """Return that of V in µeV, root mean square over the sites."""
    return 1e3 * float(np.sqrt((result["potential_std"] ** 2).mean()))


def misfits(result: xr.Dataset) -> list[tuple[str, str, str]]:
    """Return as text the name of each channel, its misfit and its noise in e²/h, if measured."""
    channels = zip(
        result["channel"].to_numpy(),
        result["misfit"].to_numpy(),
        result.attrs["noise"],
        strict=True,
    )
    return [
        (name, f"{misfit:.5f}", f"{noise:g}") if np.isfinite(misfit) else (name, "not measured", "")
        for name, misfit, noise in channels
    ]


def has_several_maxima(result: xr.Dataset) -> bool:
    """Return whether the posterior has several maxima; results of older versions do not say."""
    return result.sizes.get("maximum", 1) > 1


def shares_as_text(result: xr.Dataset) -> str:
    """Return the shares of the posterior that its maxima have, where there are several."""
    *others, last = (f"{100 * share:.0f}" for share in result["share"].to_numpy())
    return f"{', '.join(others)} and {last} %"


def verdict_sentence(result: xr.Dataset) -> str:
    """Return the verdict as a sentence."""
    verdict = result.attrs["verdict"]
    if verdict == CONVERGED:
        bar, before = error_bar(result), 1e3 * _prior_bar(result)
        known = f"V is known to {plain(bar)} µeV (r.m.s. over the sites)"
        if bar > OPEN * before:
            known += f", hardly better than before ({plain(before)} µeV)"
        explain = "this wire explains the data within their noise"
        if has_several_maxima(result):
            explain = f"{result.sizes['maximum']} wires explain the data within their noise, with "
            explain += f"{shares_as_text(result)} of the posterior"
        return f"Converged: {explain}; {known}."
    reason = {
        NOT_CONVERGED: "a better answer may have been missed",
        NOT_DESCRIBED: "no wire of this model explains the data within their noise",
    }[verdict]
    return f"{verdict.capitalize()}: {reason}, {NOT_TO_BE_TRUSTED}."


def topological_sentence(result: xr.Dataset) -> str:
    """Return in how much of the measured range T_IV is negative, as a sentence."""
    P = result["P_topological"].to_numpy()
    surely, perhaps = 100 * float((P >= SURE).mean()), 100 * float((P > 1 - SURE).mean())
    measured = f"the measured {'gate' if 'gate' in result.dims else 'µ'} and B"
    meaning = "topological where there is a gap"
    if has_dissipation(result):
        meaning += ", without its dissipation"
    if perhaps == 0:
        return f"T_IV < 0, {meaning}, nowhere in {measured}."
    share = f"{surely:.0f}" if surely == 0 or surely >= 1 else "less than 1"
    more = f", perhaps in {perhaps - surely:.0f} % more" if perhaps - surely >= 1 else ""
    return f"T_IV < 0, {meaning}, in {share} % of {measured} (P ≥ {SURE:g}){more}."


def sentences_on(result: xr.Dataset) -> list[str]:
    """Return the verdict as a sentence, and another one.

    It is where the wire is topological, if converged, and how large the discrepancy is otherwise.
    """
    converged = result.attrs["verdict"] == CONVERGED
    more = topological_sentence(result) if converged else discrepancy_sentence(result)
    return [sentence for sentence in (verdict_sentence(result), more) if sentence]


def discrepancy_sentence(result: xr.Dataset) -> str:
    """Return how large an error beside the noise is allowed for; nothing where none is."""
    left = result.get("discrepancy", xr.DataArray([0.0], dims="channel"))
    each = [f"{name} {value:.2g}" for name, value in left.to_series().items() if value > 0]
    if not each:
        return ""
    are = f"Errors beside the noise are allowed for, in e²/h: {', '.join(each)}."
    if left.attrs.get("settled", 1):
        return are
    return f"{are} They have not settled: more steps or samples may change them, and the answer."


def not_fixed_lines(result: xr.Dataset) -> list[str]:
    """Return sentences on what the data do not fix, and do not tell apart, if there is any."""
    said = {
        "not_fixed": "The data do not fix: ",
        "not_told_apart": "They do not tell apart: ",
        "at_limit": "At a limit that the prior sets, which may be too narrow: ",
    }
    return [f"{words}{text}." for name, words in said.items() if (text := result.attrs.get(name))]


def summary(result: xr.Dataset) -> list[str]:
    """Return the lines that say what `infer` has found."""
    attrs = result.attrs
    lines = [
        f"verdict         {attrs['verdict']}",
        f"from            {attrs['start']}",
        f"attempts        {attrs['attempts']}, rounds: {attrs['rounds']}",
        f"error bar of V  {error_bar(result):.3g} µeV, root mean square over the sites",
    ]
    if has_several_maxima(result):
        said = f"{result.sizes['maximum']}, with {shares_as_text(result)} of the posterior"
        lines.append(f"maxima          {said}; the mean of V is none of them")
    for name, belief in prior_of_result(result).unknown.items():
        known = prior_as_text(belief)
        lines.append(f"{name:14}  {parameter_with_std(result, name)}; before: {known}")
    if result.attrs["not_fixed"]:
        lines.append(f"not fixed       {result.attrs['not_fixed']}")
    if result.attrs.get("at_limit"):  # which results of older versions lack
        lines.append(f"at a limit      {result.attrs['at_limit']}: the prior may be too narrow")
    if result.attrs["not_told_apart"]:
        lines.append(f"not told apart  {result.attrs['not_told_apart']}")
    if attrs["verdict"] != CONVERGED:
        lines.insert(1, f"                {NOT_TO_BE_TRUSTED}")
    for name, misfit, noise in misfits(result):
        unit = f" e²/h; noise: {noise} e²/h" if noise else ""
        lines.append(f"misfit of {name}  {misfit}{unit}")
    noises = np.asarray(attrs["noise"])
    hint = stated_noise_hint(result["misfit"].to_numpy(), noises, attrs["excess"])
    return [*lines, *(line for line in (discrepancy_sentence(result), hint) if line)]
