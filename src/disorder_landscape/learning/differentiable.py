"""The conductances as an operation of TensorFlow, through which networks are trained."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from disorder_landscape.arguments import ArgumentError, names_in, require, shown
from disorder_landscape.model.parameters import TEMPERATURE, FloatArray, Nanowire
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.model.ranges import checked_temperature
from disorder_landscape.observables.conductance import conductance
from disorder_landscape.observables.gradient import conductance_gradient
from disorder_landscape.observables.grids import checked_grids

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
        Chemical potentials in meV, fields in T, biases in meV below the gap; increasing.
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
        If an argument is none of these; when called, if a tensor is, or what it says of a wire.
        (In a graph, where values are not known yet, TensorFlow raises an error of its own.)
    """
    require(isinstance(wire, Nanowire), "wire", "be a Nanowire", f"it is {shown(wire)}")
    temperature = checked_temperature(temperature)
    require(temperature > 0, "temperature", "be above zero for slopes of averages", "it is zero")
    must = f"be some of {', '.join(OF_THE_WIRE)}, each once"
    names = names_in("parameters", parameters, OF_THE_WIRE, must)
    require(len(set(names)) == len(names), "parameters", must, "one is there twice")
    grids = checked_grids([wire], mu, B, bias)
    axes = grids["mu"], grids["B"], grids["bias"]
    point = *axes, temperature
    tf = import_module("tensorflow")  # it takes seconds

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
        sizes = [axis.size for axis in axes]
        G = tf.ensure_shape(G, (tensors[0].shape[0], *sizes, len(CONDUCTANCES)))

        def slopes(upstream: Tensor) -> list[Tensor]:
            kinds = [tf.float64] * len(names)
            found = tf.nest.flatten(
                tf.py_function(of_arrays(backward), [upstream, *tensors], kinds)
            )
            return [tf.ensure_shape(of, t.shape) for of, t in zip(found, tensors, strict=True)]

        return G, slopes

    def check(tensors: Sequence[Tensor]) -> None:
        """Require the right shapes and, where there are values, wires that there can be."""
        for name, tensor in zip(names, tensors, strict=True):
            shape = [tensors[0].shape[0], wire.sites][: 2 if name == "V" else 1]
            of_sites = f"(batch, site), with {wire.sites} sites"
            must = f"have the shape {of_sites if name == 'V' else '(batch,)'}"
            fits = tensor.shape.is_compatible_with(shape) and shape[0] != 0
            require(fits, name, must, f"it is {tuple(tensor.shape)}")
        if tf.executing_eagerly():
            for values in zip(*(tensor.numpy() for tensor in tensors), strict=True):
                checked_grids([changed(values)], *axes)

    def of_tensors(*given: Tensor) -> Tensor:
        one_each = f"be one for each of {', '.join(names)}"
        require(len(given) == len(names), "tensors", one_each, f"there are {len(given)}")
        tensors = [_tensor(tf, name, value) for name, value in zip(names, given, strict=True)]
        doubles = [tf.cast(tensor, tf.float64) for tensor in tensors]
        check(doubles)
        return tf.cast(operation(*doubles), tensors[0].dtype)

    return of_tensors


def _tensor(tf: Any, name: str, value: object) -> Tensor:
    """Return a tensor of real numbers."""
    must = "be a tensor of real numbers"
    try:
        tensor = tf.convert_to_tensor(value)
    except Exception as error:  # of any kind: TensorFlow's own, and those of what it asks
        raise ArgumentError(name, must, f"it is {shown(value)}") from error
    require(tensor.dtype.is_floating, name, must, f"its numbers are {tensor.dtype.name}")
    require(tensor.shape.rank != 0, name, "have a batch of wires", "it is one number")
    return tensor
