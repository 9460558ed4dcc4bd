"""The lines and sentences that say what `infer` has found."""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.inference.inferred import prior_of_result
from disorder_landscape.inference.noise_hints import stated_noise_hint
from disorder_landscape.inference.problem.distributions import Distribution, Uniform
from disorder_landscape.inference.problem.unknowns import Unknowns
from disorder_landscape.inference.result import OPEN
from disorder_landscape.inference.verdict import CONVERGED, NOT_CONVERGED, NOT_DESCRIBED

SURE = 0.95
"""What at least this share of the samples has is taken for sure."""

MOSTLY_ITS_MEAN = 0.5
"""What is uncertain of V is mostly its mean, if the error bar without it is less than this part."""
SAID = 4
"""Of so many maxima of the posterior the shares are said."""

NEGATIVE = "The topological visibility T_IV is negative"
NOT_TO_BE_TRUSTED = "so neither error bars nor P(topological) are to be trusted"


def parameter_with_std(result: xr.Dataset, name: str) -> str:
    """Return an unknown parameter and its standard deviation as text."""
    mean, std = float(result[f"{name}_mean"]), float(result[f"{name}_std"])
    digits = max(0, int(1 - np.floor(np.log10(std)))) if std > 0 else 6
    return f"{mean:z.{digits}f} ± {std:.{digits}f}{_unit(result, name)}"


def prior_as_text(result: xr.Dataset, name: str, belief: Distribution) -> str:
    """Return what was known of an unknown parameter as text."""
    if isinstance(belief, Uniform):
        return f"{belief.low:g} to {belief.high:g}{_unit(result, name)}"
    return f"{belief.mean:g} ± {belief.std:g}{_unit(result, name)}"


def _unit(result: xr.Dataset, name: str) -> str:
    unit = result[name].attrs["units"]
    return "" if unit == "1" else f" {unit}"


def plain(number: float) -> str:
    """Return a number with two digits, and no exponent where it is neither large nor small."""
    return f"{float(f'{number:.2g}'):g}"


def _prior_bar(result: xr.Dataset) -> float:
    """Return the prior's standard deviation of V in meV, root mean square over the sites."""
    unknowns = Unknowns(prior_of_result(result))
    return unknowns.site_std(unknowns.white_noise.covariance)


def has_dissipation(result: xr.Dataset) -> bool:
    """Return whether the wire of a result has dissipation, or may have it."""
    return "dissipation" in result or bool(result.attrs.get("dissipation", 0.0))


def error_bar(result: xr.Dataset) -> float:
    """Return that of V in µeV, root mean square over the sites."""
    return 1e3 * float(np.sqrt((result["potential_std"] ** 2).mean()))


def shape_error_bar(result: xr.Dataset) -> float:
    """Return that of V less its mean over the sites in µeV, from the samples."""
    V = result["potential"]
    return 1e3 * float(np.sqrt((V - V.mean("site")).var("sample").mean()))


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
    """Return as words the shares of the posterior that its maxima have, where there are several."""
    shares = result["share"].to_numpy()
    *others, last = (f"{100 * share:.0f}" for share in shares[:SAID])
    words = f"{', '.join(others)} and {last} % of the posterior"
    return words if shares.size <= SAID else f"{words}, and so on"


def verdict_sentence(result: xr.Dataset) -> str:
    """Return the verdict as a sentence."""
    verdict = result.attrs["verdict"]
    if verdict == CONVERGED:
        bar, before = error_bar(result), 1e3 * _prior_bar(result)
        known = f"V is known to {plain(bar)} µeV (r.m.s. over the sites)"
        if (shape := shape_error_bar(result)) < MOSTLY_ITS_MEAN * bar:
            known += f", and to {plain(shape)} µeV but for its mean"
        if bar > OPEN * before:
            known += f", hardly better than before ({plain(before)} µeV)"
        explain = "this wire explains the data within their noise"
        if has_several_maxima(result):
            explain = f"{result.sizes['maximum']} wires explain the data within their noise, with "
            explain += shares_as_text(result)
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
    first = "gate" if "gate" in result.dims else "mu"
    names = {first: "gate voltages" if first == "gate" else "µ", "B": "B"}
    several = [words for axis, words in names.items() if result.sizes[axis] > 1]
    measured = f"the measured {' and '.join(several or names.values())}"
    meaning = "topological where there is a gap"
    if has_dissipation(result):
        meaning += ", without its dissipation"
    if perhaps == 0:
        return f"{NEGATIVE}, {meaning}, nowhere in {measured}."
    share = f"{surely:.0f}" if surely == 0 or surely >= 1 else "less than 1"
    more = f", perhaps in {perhaps - surely:.0f} % more" if perhaps - surely >= 1 else ""
    return f"{NEGATIVE}, {meaning}, in {share} % of {measured} (P ≥ {SURE:g}){more}."


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
        said = f"{result.sizes['maximum']}, with {shares_as_text(result)}"
        lines.append(f"maxima          {said}; the mean of V is none of them")
    for name, belief in prior_of_result(result).unknown.items():
        known = prior_as_text(result, name, belief)
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
