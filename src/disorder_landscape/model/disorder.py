"""The disorder potential: correlated noise, its cosine components, their truncation (S-I, S-II.1).

A potential of N sites is V = c₀ φ₀ + Σ_n c_n φ_n with the orthonormal DCT-II basis
φ_n(i) = √(2/N) cos(πn(i+½)/N), φ₀ = 1/√N, so that components are in meV and V·V = c·c.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.fft import dct, idct

from disorder_landscape.arguments import require
from disorder_landscape.model.parameters import FloatArray

NOISE_STD = 1.5
"""Standard deviation of the white noise per site in meV (S-II.1)."""
CORRELATION_LENGTH = 3.0
"""Correlation length ℓ in sites (S-II.1)."""
KERNEL_REACH = 7
"""The kernel is cut at |x| ≤ 7 sites: with ℓ = 3 and 7 this gives the published 54, 29 and 33."""
MEAN_STD = 0.01
"""Standard deviation in meV of the mean potential that is left in (S-II.1)."""
AMPLITUDES = ("sum", "double", "unit-variance")
"""Readings of "amplitude 1.5 meV": kernel of sum 1, of sum 2, or 1.5 meV after smoothing."""


def kernel(correlation_length: float = CORRELATION_LENGTH, amplitude: str = "sum") -> FloatArray:
    """Return the smoothing kernel exp(−x²/ℓ²), |x| ≤ 7 sites, shape (15,)."""
    x = np.arange(-KERNEL_REACH, KERNEL_REACH + 1)
    k = np.exp(-((x / correlation_length) ** 2))
    require(amplitude in AMPLITUDES, "amplitude", f"be one of {AMPLITUDES}", f"it is {amplitude!r}")
    scale = {"sum": 1 / k.sum(), "double": 2 / k.sum(), "unit-variance": 1 / np.sqrt(k @ k)}
    return np.asarray(k * scale[amplitude])


def noise_std_of(amplitude: str, correlation_length: float = CORRELATION_LENGTH) -> float:
    """Return the standard deviation of the noise in meV that with "sum" is this amplitude."""
    return NOISE_STD * float(kernel(correlation_length, amplitude).sum())


def smooth_noise(
    rng: np.random.Generator,
    sites: int,
    correlation_length: float = CORRELATION_LENGTH,
    amplitude: str = "sum",
    noise_std: float = NOISE_STD,
) -> FloatArray:
    """Draw white Gaussian noise and convolve it with the kernel (S-II.1), shape (site,), in meV.

    The noise reaches beyond both ends, so that the statistics are the same on every site.
    """
    noise = rng.normal(0.0, noise_std, sites + 2 * KERNEL_REACH)
    return np.convolve(noise, kernel(correlation_length, amplitude), mode="valid")


def cosine_components(potential: FloatArray) -> FloatArray:
    """Return all components c₀ … c_{N−1} of a potential (last axis), in meV."""
    return np.asarray(dct(potential, type=2, norm="ortho", axis=-1))


def potential_from_components(
    components: FloatArray, sites: int, mean: float | FloatArray = 0.0
) -> FloatArray:
    """Return V_dis(x) of the components c₁ … c_n and of a mean in meV.

    Parameters
    ----------
    components : array, shape (…, n)
        c₁ … c_n in meV.
    sites : int
        Number of sites N > n.
    mean : float or array, shape (…)
        Spatial mean of the potential in meV.

    Returns
    -------
    array, shape (…, site)
    """
    n = components.shape[-1]
    require(0 < n < sites, "components", f"number between 1 and {sites - 1}", f"there are {n}")
    full = np.zeros((*components.shape[:-1], sites))
    full[..., 1 : n + 1] = components
    V = idct(full, type=2, norm="ortho", axis=-1) + np.asarray(mean)[..., None]
    return np.asarray(V)


def positions(sites: int, lattice: float) -> FloatArray:
    """Return x of the sites, (site,) in µm, of a lattice spacing in nm.

    Each is in the middle of its spacing, as in the components' φ_n(i).
    """
    return (np.arange(sites) + 0.5) * lattice / 1000


@lru_cache
def mean_reduction(
    sites: int,
    correlation_length: float = CORRELATION_LENGTH,
    amplitude: str = "sum",
    noise_std: float = NOISE_STD,
    mean_std: float = MEAN_STD,
) -> float:
    """Return κ, by which the mean c₀/√N of the noise is multiplied to get the given std.

    Its standard deviation before is exact: each white-noise value enters the mean with the weight
    that the kernel gives it within the wire.
    """
    weights = np.convolve(np.ones(sites), kernel(correlation_length, amplitude), mode="full")
    return float(mean_std / (noise_std * np.sqrt(weights @ weights) / sites))


def disorder_realization(
    rng: np.random.Generator,
    components: int,
    sites: int,
    correlation_length: float = CORRELATION_LENGTH,
    amplitude: str = "sum",
    noise_std: float = NOISE_STD,
    mean_std: float = MEAN_STD,
) -> tuple[FloatArray, FloatArray]:
    """Draw one disorder potential of the truncated model (S-II.1).

    Returns
    -------
    components : array, shape (n,)
        c₁ … c_n in meV, the labels.
    potential : array, shape (site,)
        V_dis(x) in meV, its mean reduced: V − (1−κ)c₀/√N.
    """
    noise = smooth_noise(rng, sites, correlation_length, amplitude, noise_std)
    c = cosine_components(noise)
    kappa = mean_reduction(sites, correlation_length, amplitude, noise_std, mean_std)
    labels = c[1 : components + 1]
    return labels, potential_from_components(labels, sites, kappa * c[0] / np.sqrt(sites))


def component_covariance(
    components: int,
    sites: int,
    correlation_length: float = CORRELATION_LENGTH,
    amplitude: str = "sum",
    noise_std: float = NOISE_STD,
    mean_std: float = MEAN_STD,
) -> FloatArray:
    """Return the covariance of c₁ … c_n and of the mean of V in this disorder model, exactly.

    The components are linear in the white noise, each of whose values is independent.

    Returns
    -------
    array, shape (n + 1, n + 1)
        In meV²; the mean of V, as it is left in, comes last.
    """
    reach = sites + 2 * KERNEL_REACH
    taps = kernel(correlation_length, amplitude)
    smoothing = np.array([np.convolve(row, taps, mode="valid") for row in np.eye(reach)])
    of_noise = noise_std * cosine_components(smoothing)[:, : components + 1]
    kappa = mean_reduction(sites, correlation_length, amplitude, noise_std, mean_std)
    of_noise = np.column_stack([of_noise[:, 1:], kappa * of_noise[:, 0] / np.sqrt(sites)])
    return np.asarray(of_noise.T @ of_noise)


def fidelity_by_components(
    correlation_length: float, sites: int, samples: int = 1000, seed: int = 0
) -> FloatArray:
    """Return the mean fidelity F of S-II.3 of untruncated disorder cut to 1, 2, … N components.

    F = V·V_pred / √((V·V)(V_pred·V_pred)); with V_pred the truncation of V, F² is the share of
    V·V in the components kept (the DC component counts as one of them).

    Parameters
    ----------
    correlation_length : float
        ℓ in sites.
    sites : int
        Length of the wire.
    samples : int
        Potentials to average over.
    seed : int

    Returns
    -------
    array, shape (site,)
        Increasing, the last is 1.
    """
    rng = np.random.default_rng(seed)
    noise = np.array([smooth_noise(rng, sites, correlation_length) for _ in range(samples)])
    power = cosine_components(noise) ** 2
    share = np.cumsum(power, axis=1) / power.sum(axis=1, keepdims=True)
    return np.asarray(np.sqrt(share).mean(axis=0))


def components_required(
    fidelity: float, correlation_length: float, sites: int, samples: int = 1000, seed: int = 0
) -> int:
    """Return how many components give a mean fidelity, as `fidelity_by_components` has it."""
    reached = fidelity_by_components(correlation_length, sites, samples, seed)
    return int(np.argmax(reached >= fidelity)) + 1
