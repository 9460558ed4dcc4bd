"""Scores and p-values from the mismatches of a prediction and of wrong disorder."""

from __future__ import annotations

import numpy as np
import xarray as xr

from disorder_landscape.model.parameters import FloatArray
from disorder_landscape.model.quantities import CONDUCTANCES

SIGNIFICANCE = 0.05
"""Largest p-value of a prediction that passes."""
UNLIKELY = 0.02
"""Largest predictive p-value at which further data contradict an inversion."""
LEAST_SAMPLES = round(1 / UNLIKELY) - 1
"""Of fewer samples no p-value is so small."""
LEAST_SIGNAL = 0.5
"""Share of the mismatch of wrong disorder that must not be noise, in one channel at least."""
OF_CHANNELS = ("mismatch", "control_mismatch", "noise", "ratio")
"""Variables of a result that are NaN for channels that were not measured."""
_TINY = np.finfo(float).tiny


def weights(typical: FloatArray, noise: FloatArray) -> FloatArray:
    """Return the share of typical mismatches that is not noise, shape (measurement, channel).

    None where nothing was measured.
    """
    share = np.clip(1 - (noise / np.maximum(typical, _TINY)) ** 2, 0.0, 1.0)
    return np.where(np.isnan(share), 0.0, share)


def scores(squares: FloatArray, typical: FloatArray, noise: FloatArray) -> FloatArray:
    """Return root mean squares of mismatches in units of typical ones, weighted.

    Parameters
    ----------
    squares : array, shape (…, measurement, channel)
        Squared mismatches in (e²/h)², NaN where nothing was measured.
    typical : array, shape (measurement, channel)
        Mismatches of wrong disorder in e²/h.
    noise : array, shape (measurement, channel)
        In e²/h.

    Returns
    -------
    array, shape (…)
    """
    weight = weights(typical, noise)
    relative = squares / np.maximum(typical, _TINY) ** 2
    weighted = np.nansum(relative * weight, axis=(-2, -1))
    return np.asarray(np.sqrt(weighted / max(weight.sum(), _TINY)))


def comparison(mismatch: FloatArray, shift: FloatArray, noise: FloatArray) -> xr.Dataset:
    """Return `verify`'s result from mismatches (wire, measurement, channel) and shifts (wire,).

    The first wire is the predicted one, the others are controls; noise has the shape (measurement,
    channel).
    """
    typical = np.median(mismatch[1:], axis=0)
    score = scores(mismatch**2, typical, noise)
    as_close, controls = int(np.sum(score[1:] <= score[0])), len(score) - 1
    p = (1 + as_close) / (1 + controls)  # the prediction counts as one more try
    channels = ("measurement", "channel")
    data = {
        "mismatch": (channels, mismatch[0], {"units": "e^2/h"}),
        "control_mismatch": (("control", *channels), mismatch[1:], {"units": "e^2/h"}),
        "noise": (channels, noise, {"units": "e^2/h"}),
        "ratio": (channels, mismatch[0] / np.maximum(typical, _TINY), {"units": "1"}),
        "score": ((), score[0], {"units": "1"}),
        "control_score": ("control", score[1:], {"units": "1"}),
        "shift": ((), shift[0], {"units": "meV"}),
        "control_shift": ("control", shift[1:], {"units": "meV"}),
        "p_value": ((), p, {"units": "1"}),
    }
    attrs = {"verdict": _verdict(score[0], as_close, controls, p)}
    if weights(typical, noise).max() < LEAST_SIGNAL:
        attrs["verdict"] = "Nothing can be said: the noise hides what wrong disorder would change."
    return xr.Dataset(data, coords={"channel": list(CONDUCTANCES)}, attrs=attrs)


def _verdict(score: float, as_close: int, controls: int, p: float) -> str:
    result = "passes" if p <= SIGNIFICANCE else "fails"
    return (
        f"The prediction {result}: its mismatch is {score:.2g} times that of wrong disorder, and "
        f"{as_close or 'none'} of {controls} wires with wrong disorder came as close (p = {p:.2g})."
    )


def of_samples(p: float) -> str:
    """Return what `predictive_p` of an inversion's samples means; NaN is that of too few."""
    if np.isnan(p):
        return f"Fewer than {LEAST_SAMPLES} samples cannot say if the posterior predicts the data."
    but = "does not predict these data: its error bars, its model or the stated noise is wrong"
    return (
        f"The posterior {'predicts these data' if p > UNLIKELY else but} (predictive p = {p:.2g})."
    )


def table(result: xr.Dataset) -> list[str]:
    """Return the lines of a table of the result of `verify`, in e²/h, and its verdict."""
    lines = [
        f"{'measurement':30} channel  mismatch  wrong disorder: median  smallest   ratio",
    ]
    wrong = result["control_mismatch"].to_numpy()
    for i, name in enumerate(result["measurement"].to_numpy()):
        for c, channel in enumerate(result["channel"].to_numpy()):
            begin = f"{str(name)[-30:] if c == 0 else '':30} {channel:7} "
            if np.isnan(wrong[0, i, c]):
                lines.append(f"{begin}not measured")
                continue
            mismatch, ratio = (result[of].to_numpy()[i, c] for of in ("mismatch", "ratio"))
            median, least = np.median(wrong[:, i, c]), wrong[:, i, c].min()
            lines.append(f"{begin}{mismatch:9.5f} {median:23.5f} {least:9.5f} {ratio:7.3f}")
    shift = 1e3 * float(result["shift"])
    noises = result["noise"].to_numpy()
    noise = ", ".join(f"{one:g}" for one in np.unique(noises[np.isfinite(noises)]))
    lines.append(f"mean of V that fits best: {shift:g} µeV; noise: {noise} e²/h")
    lines.append(str(result.attrs["verdict"]))
    if "p_samples" in result:
        lines.append(of_samples(float(result["p_samples"])))
    return lines
