"""The conductances as an operation of TensorFlow, through which networks are trained."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import require, shown
from disorder_landscape.model.parameters import TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.gradient import conductance_gradient

Tensor = Any
"""Of TensorFlow, which has no types."""
OF_THE_WIRE = ("V", "alpha", "g", "gamma", "delta0", "critical_field")
"""What a tensor may stand for."""


def differentiable_conductance(
    wire: Nanowire,
    mu: ArrayLike,
    B: ArrayLike,
    bias: ArrayLike = 0.0,
    temperature: float = TEMPERATURE,
    parameters: Sequence[str] = ("V",),
) -> Callable[..., Tensor]:
    """Return the conductances as a function of tensors, with its gradient (backward mode).

    Parameters
    ----------
    wire : Nanowire
        Has what is not given by tensors.
    mu, B, bias : float or array
        Chemical potentials in meV, fields in T, biases in meV; increasing.
    temperature : float
        In K, above zero.
    parameters : sequence of str
        What the tensors stand for, in this order: "V", the potential without barriers, "alpha",
        "g", "gamma", "delta0", "critical_field".

    Returns
    -------
    callable
        Takes one tensor for each parameter, of shape (batch, site) for "V" and (batch,) else, and
        returns G_LL, G_RR, G_LR, G_RL in e²/h, shape (batch, mu, B, bias, 4).

    Raises
    ------
    ArgumentError
        If a parameter is unknown; when called, what `conductance` raises.
    """
    tf = import_module("tensorflow")  # it takes seconds

    names = [parameters] if isinstance(parameters, str) else list(parameters)
    for name in names:
        must = f"be some of {', '.join(OF_THE_WIRE)}"
        require(name in OF_THE_WIRE, "parameters", must, f"one is {shown(name)}")
    require(temperature > 0, "temperature", "be above zero for slopes of averages", "it is zero")
    point = mu, B, bias, temperature

    def changed(values: Sequence[FloatArray]) -> Nanowire:
        named = zip(names, values, strict=True)
        fields: dict[str, Any] = {"potential" if n == "V" else n: value for n, value in named}
        return replace(wire, **fields)

    def forward(*batch: FloatArray) -> FloatArray:
        each = [conductance(changed(values), *point) for values in zip(*batch, strict=True)]
        return np.array([np.stack([G[name] for name in CONDUCTANCES], axis=-1) for G in each])

    def backward(weights: FloatArray, *batch: FloatArray) -> list[FloatArray]:
        rows = []
        for w, values in zip(weights, zip(*batch, strict=True), strict=True):
            of = xr.Dataset({name: (AXES, w[..., k]) for k, name in enumerate(CONDUCTANCES)})
            slopes = conductance_gradient(changed(values), *point, parameters=names, weights=of)
            rows.append([slopes[name].to_numpy() for name in names])
        return [np.array(column) for column in zip(*rows, strict=True)]

    def of_arrays(function: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *given: function(*(tensor.numpy() for tensor in given))

    @tf.custom_gradient  # type: ignore[untyped-decorator]
    def operation(*tensors: Tensor) -> tuple[Tensor, Callable[[Tensor], Any]]:
        G = tf.py_function(of_arrays(forward), tensors, tf.float64)
        grids = [np.atleast_1d(np.asarray(axis)).size for axis in (mu, B, bias)]
        G = tf.ensure_shape(G, (tensors[0].shape[0], *grids, len(CONDUCTANCES)))

        def slopes(upstream: Tensor) -> list[Tensor]:
            kinds = [tf.float64] * len(names)
            found = tf.nest.flatten(
                tf.py_function(of_arrays(backward), [upstream, *tensors], kinds)
            )
            return [tf.ensure_shape(of, t.shape) for of, t in zip(found, tensors, strict=True)]

        return G, slopes

    def of_tensors(*tensors: Tensor) -> Tensor:
        kind = tf.convert_to_tensor(tensors[0]).dtype
        return tf.cast(operation(*(tf.cast(t, tf.float64) for t in tensors)), kind)

    return of_tensors
