"""Arguments of every kind for hypothesis, valid and odd, and what a call must answer to them."""

from __future__ import annotations

import datetime
import signal
import warnings
from contextlib import contextmanager, suppress
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from disorder_landscape import ArgumentError
from disorder_landscape.model.quantities import AXES, CONDUCTANCES

SECONDS = 20
"""So long a call may take."""
MANY = 10_000
"""Sets of arguments that the slow tests try."""
PHASES = [Phase.explicit, Phase.generate, Phase.shrink]


def argument_sets(few):
    """Parametrise a test with how many sets of arguments it tries: few, or many."""
    return pytest.mark.parametrize("count", [few, pytest.param(MANY, marks=pytest.mark.slow)])


def tried(count, strategy, check):
    """Check so many sets of arguments: few are always the same, so that no chance fails them."""
    quiet = [HealthCheck.too_slow, HealthCheck.large_base_example, HealthCheck.data_too_large]

    @settings(
        max_examples=count,
        derandomize=count < MANY,
        deadline=None,
        suppress_health_check=quiet,
        phases=PHASES,
    )
    @given(strategy)
    def check_one(arguments):
        check(arguments)

    check_one()


@contextmanager
def in_time():
    """End what takes longer than a call may."""

    def give_up(number, frame):
        raise AssertionError(f"it takes more than {SECONDS} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def answer(call):
    """Return what a call answers, or nothing if it refuses in one sentence; it may not warn."""
    with in_time(), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return call()
        except ArgumentError as error:
            said = str(error)
    assert said.startswith("Argument ")
    assert " must " in said
    assert said.endswith(".")
    assert "\n" not in said
    assert len(said) < 2000
    return None


class Odd:
    """Nothing that anyone can use."""

    def __repr__(self):
        return "Odd()"


SCALARS = [0, 1, -1, 2, 10**6, -(10**6), 10**30, 10**400, -(10**400)]
SCALARS += [0.0, -0.0, 1.0, -1.0, 0.05, 0.5, 1e-300, 5e-324, 1e300, -1e300, 1.7e308]
SCALARS += [float("nan"), float("inf"), -float("inf"), True, False, None, ..., Odd(), Odd, len]
SCALARS += ["", "x", "0.3", "nan", "1e5", " ", "é", "0.1,0.2", b"1", b"", bytearray(b"0.1")]
SCALARS += [1j, 0.1 + 0j, Decimal("0.1"), Decimal("NaN"), Fraction(1, 3), range(3), slice(2)]
SCALARS += [np.float32(0.05), np.float16(0.1), np.longdouble(0.2), np.longdouble("1e4000")]
SCALARS += [np.int8(1), np.uint64(2**63), np.bool_(True), np.str_("0.1"), np.complex128(1 + 1j)]
SCALARS += [np.datetime64("1970-01-01"), np.datetime64("NaT"), np.timedelta64(0, "s")]
SCALARS += [datetime.date(2020, 1, 1), datetime.timedelta(0), np.array(0.1), np.array([0.1])]
SCALARS += [np.array([]), np.zeros((2, 2)), np.array(None), [], [0.1], (0.1,), {}, {"a": 1}]
SCALARS += [{1, 2}, [[1], [1, 2]], ((0.1, 0.2), (0.3,)), np.ma.masked, np.array([1 + 1j])]
SCALARS += [xr.DataArray(0.1), xr.DataArray([0.1, 0.2], dims="x"), xr.Dataset()]
SCALARS += [np.array(["a"]), np.array([0.1, 0.2])]
"""What may stand where one number is expected, some of it a number."""


def odd_scalars():
    """Draw one of these, or any float."""
    return st.one_of(st.sampled_from(SCALARS), st.floats(), st.integers())


def number(low, high, odds=6):
    """Draw a number of a range, its ends among them, and now and then something else."""
    usual = st.one_of(st.floats(low, high), st.sampled_from([low, high, (low + high) / 2]))
    return st.one_of(*[usual] * odds, odd_scalars())


def small_grid(low, high, most=2):
    """Draw a short increasing list of numbers of a range, in one of many forms."""
    values = st.lists(
        st.one_of(st.floats(low, high), st.sampled_from([low, high, (low + high) / 2])),
        min_size=1,
        max_size=most,
        unique=True,
    ).map(sorted)
    return st.builds(_in_form, values, st.sampled_from(sorted(FORMS)))


FORMS = {
    "list": list,
    "tuple": tuple,
    "array": np.array,
    "twice as long, every second": lambda v: np.repeat(v, 2)[::2],
    "reversed twice": lambda v: np.array(v[::-1])[::-1],
    "read-only": lambda v: _read_only(np.array(v)),
    "other bytes": lambda v: np.array(v, dtype=">f8"),
    "objects": lambda v: np.array(v, dtype=object),
    "named": lambda v: xr.DataArray(v, dims="x"),
    "texts": lambda v: [repr(x) for x in v],
    "first alone": lambda v: v[0],
    "0-d": lambda v: np.array(v[0]),
    "numpy's": lambda v: [np.float64(x) for x in v],
    "generator": lambda v: (x for x in v),
}


def _in_form(values, form):
    return FORMS[form](values)


def _read_only(values):
    values.setflags(write=False)
    return values


ODD_GRIDS = [
    [],
    [[]],
    [[0.0, 0.1]],
    np.zeros((1, 1, 1)),
    [0.1, 0.0],
    [0.0, 0.0],
    [0.0, -0.0],
    [0.0, 5e-324],
    [0.0, float("nan")],
    [float("nan")] * 2,
    [-float("inf"), float("inf")],
    [-1.7e308, 1.7e308],
    [0.0, None],
    [None],
    [0, 10**400],
    [0, "x"],
    ["0", "0.1"],
    [True, False],
    [False, True],
    [0.0, 0.1j],
    [[0.0], [0.1, 0.2]],
    np.array([0.1 + 1j]),
    np.array([0.1 + 0j, 0.2]),
    np.array([False, True]),
    np.array([0, 1], dtype="M8[s]"),
    np.array([0, 1], dtype="m8[s]"),
    np.array(["0.1"]),
    np.array([b"0.1"]),
    np.array([0, 1], dtype=np.uint8),
    np.array([0.0, 1e4000], dtype=np.longdouble),
    np.array([np.longdouble("1e4000")]),
    np.array([(0.1, 0.2)], dtype=[("a", "f8"), ("b", "f8")]),
    np.ma.array([0.1, 0.2], mask=[False, True]),
    np.array([Odd()]),
    xr.DataArray([[0.1]], dims=["a", "b"]),
    xr.Dataset({"mu": ("mu", [0.1])}),
    "0.1,0.2",
    range(2),
    {0.1: 1},
    memoryview(b"ab"),
]
"""What may stand where a grid is expected, some of it a grid."""


def grid(low, high, most=2, odds=6):
    """Draw a grid, and now and then something else."""
    odd = st.one_of(st.sampled_from(ODD_GRIDS), odd_scalars())
    return st.one_of(*[small_grid(low, high, most)] * odds, odd)


def some_changed(usual, odd):
    """Draw arguments: each the usual one, or (one in so many) what its strategy draws."""

    @st.composite
    def draw_all(draw):
        chosen = dict(usual)
        for name in draw(st.lists(st.sampled_from(sorted(odd)), max_size=3, unique=True)):
            chosen[name] = draw(odd[name])
        return chosen

    return draw_all()


# Datasets


def _drop(G, draw):
    return G.drop_vars(draw(st.lists(st.sampled_from(list(G.variables)), max_size=3, unique=True)))


def _keep(G, draw):
    return G[draw(st.lists(st.sampled_from(list(G.data_vars)), max_size=3, unique=True))]


def _transpose(G, draw):
    return G.transpose(*draw(st.permutations(list(G.dims))))


def _select(G, draw):
    dim = draw(st.sampled_from(list(G.dims)))
    size = G.sizes[dim]
    index = st.integers(0, max(size - 1, 0))
    which = index if size else st.just([])
    which = st.one_of(which, st.lists(index, max_size=size), st.just(slice(None, None, -1)))
    return G.isel({dim: draw(which)})


def _select_in_one(G, draw):
    name, dim = draw(st.sampled_from(list(G.data_vars))), draw(st.sampled_from(list(G.dims)))
    if dim not in G[name].dims or not G.sizes[dim]:
        return G
    return G.assign({name: G[name].isel({dim: 0}, drop=True)})


def _expand(G, draw):
    dim = draw(st.sampled_from(["realization", "x", "sample", "lead"]))
    size = draw(st.one_of(st.integers(0, 3), st.just(["a", "b"])))
    if dim in G.variables or dim in G.dims:
        return G
    name = draw(st.sampled_from([None, *G.data_vars]))
    if name is None:
        return G.expand_dims({dim: size})
    return G.assign({name: G[name].expand_dims({dim: size})})


def _rename(G, draw):
    old = draw(st.sampled_from([*G.variables, *(d for d in G.dims if d not in G.variables)]))
    new = draw(st.sampled_from(["other", "G_LL", "mu", "B", "alpha", "µ", "", "potential"]))
    if new in G.variables or new in G.dims:
        return G
    return G.rename({old: new}) if new != old else G


ODD_VALUES = [np.nan, np.inf, -np.inf, 0.0, -0.0, 5e-324, 1e-5, 3.9, 4.1, 100.0, 1e30, 1e300, -1.0]


def _hole(G, draw):
    name = draw(st.sampled_from(list(G.data_vars)))
    values = G[name].to_numpy().copy()
    value = draw(st.sampled_from(ODD_VALUES))
    if values.dtype.kind != "f":
        return G
    if draw(st.booleans()) or not values.size:
        values[...] = value
    else:
        values.flat[draw(st.integers(0, values.size - 1))] = value
    return G.assign({name: (G[name].dims, values, G[name].attrs)})


def _scale(G, draw):
    name = draw(st.sampled_from(list(G.data_vars)))
    if G[name].dtype.kind not in "fiu":
        return G
    factor = draw(st.sampled_from([0.0, 1e-5, 1e-3, 1.5, -1.0, 100.0, 1e20]))
    return G.assign({name: (G[name].dims, factor * G[name].to_numpy(), G[name].attrs)})


KINDS = ["f2", "f4", ">f8", "g", "i2", "u1", "c16", "U5", "S5", "O", "?", "M8[ns]", "m8[ns]"]


def _as_kind(G, draw):
    name = draw(st.sampled_from(list(G.variables)))
    kind = draw(st.sampled_from(KINDS))
    values = G[name].to_numpy()
    if values.dtype.kind not in "fiu" or not np.isfinite(values.astype(float)).all():
        return G
    if kind in ("M8[ns]", "m8[ns]", "i2", "u1"):
        values = np.clip(values, 0, 1).astype(int)
    elif kind in ("f2", "f4", "U5"):
        values = np.clip(values, -1e3, 1e3)
    return _with(G, name, (G[name].dims, values.astype(kind), G[name].attrs))


def _with(G, name, value):
    return G.assign_coords({name: value}) if name in G.coords else G.assign({name: value})


def _other_axis(G, draw):
    axis = draw(st.sampled_from([axis for axis in G.dims if axis in G.coords] or [None]))
    if axis is None or G[axis].dtype.kind not in "fiu":
        return G
    old, n = G[axis].to_numpy(), G.sizes[axis]
    new = draw(
        st.sampled_from(
            [
                old + 1e-9,
                old + 1e-3,
                old * 10,
                old * 1e4,
                old[::-1],
                np.full(n, np.nan),
                np.full(n, np.inf),
                np.arange(n),
                np.zeros(n),
                np.array([str(k) for k in range(n)], dtype=str),
                np.array([None] * n, dtype=object),
                np.array([0.1, *["a"] * (n - 1)][:n], dtype=object),
                old + 1j,
                np.arange(n).astype("M8[ns]"),
            ]
        )
    )
    return G.assign_coords({axis: (axis, new, draw(st.sampled_from([{}, {"units": "meV"}])))})


def _axis_elsewhere(G, draw):
    """Make an axis a coordinate of another dimension, or of none."""
    axis = draw(st.sampled_from([axis for axis in G.dims if axis in G.coords] or [None]))
    if axis is None:
        return G
    if draw(st.booleans()):
        return G.rename({axis: "x"}).assign_coords({axis: ("x", G[axis].to_numpy())})
    return G.drop_vars(axis).rename({axis: "x"}).assign_coords({axis: 0.1})


ATTRIBUTES = ["temperature", "barrier", "theta", "noise", "alpha", "g", "gamma", "config_hash"]
ATTRIBUTES += ["mass", "lattice", "delta0", "dissipation", "lead_mu", "units", "other"]
USUAL_ATTRIBUTES = [0.05, 0.0, 0.001, 8.0, 25.0, 15.0, [15.0, 12.0], (0.1,), np.array([15.0, 15.0])]
USUAL_ATTRIBUTES += [[0.01] * 4, np.full((4, 1), 0.1), np.full((2, 2), 0.1), [1, [2, 3]], "15,15"]


def _attribute(G, draw):
    name = draw(st.sampled_from(ATTRIBUTES))
    value = draw(st.one_of(st.sampled_from(USUAL_ATTRIBUTES), odd_scalars()))
    return G.assign_attrs({name: value})


def _no_attribute(G, draw):
    new = G.copy()
    for name in draw(st.lists(st.sampled_from(sorted(map(str, G.attrs))), max_size=3)):
        new.attrs.pop(name, None)
    return new


UNITS = ["", "e^2/h", "S", "meV", "mV", "T", "tesla", "eV", "s", "days since 2000-01-01", None, 3]


def _units(G, draw):
    name = draw(st.sampled_from(list(G.variables)))
    new = G.copy()
    new[name].attrs["units"] = draw(st.sampled_from([*UNITS, np.array([1, 2]), ["e^2/h"]]))
    return new


def _lazy(G, draw):
    return G.chunk()


def _several(G, draw):
    dims = [dim for dim in G.dims if dim in G.coords]
    return G.stack(all=dims) if dims and "all" not in G.dims else G


def _longer_dim(G, draw):
    """Give a dimension to a variable of its own only."""
    name = draw(st.sampled_from(["realization", "sample", "site", "component", "member"]))
    if name in G.dims or name in G.variables:
        return G
    return G.assign(further=(name, np.arange(draw(st.integers(0, 3)))))


CHANGES = [_drop, _keep, _transpose, _select, _select_in_one, _expand, _rename, _hole, _scale]
CHANGES += [_as_kind, _other_axis, _axis_elsewhere, _attribute, _no_attribute, _units, _lazy]
CHANGES += [_several, _longer_dim]

NO_DATASETS = [None, 3, "wire.nc", [], {}, np.zeros((2, 2, 2)), xr.DataArray([0.1]), xr.Dataset()]
NO_DATASETS += [Odd(), xr.Dataset(coords={"mu": [0.1]}), xr.DataTree(), (1, 2), b""]


def datasets(usual, most=3, odds=12):
    """Draw a dataset with up to so many changes, and now and then something else."""

    @st.composite
    def changed(draw):
        G = draw(st.sampled_from(usual))
        for change in draw(st.lists(st.sampled_from(CHANGES), max_size=most)):
            if G.data_vars:
                with warnings.catch_warnings(), np.errstate(all="ignore"):
                    warnings.simplefilter("ignore")
                    # xarray itself may refuse: then there is no such dataset
                    with suppress(ValueError, TypeError, KeyError, NotImplementedError):
                        G = change(G, draw)
        return G

    return st.one_of(*[changed()] * odds, st.sampled_from(NO_DATASETS))


def require_numbers(G, dims, least=-np.inf, most=np.inf):
    """Require finite numbers over these dimensions, within bounds."""
    assert G.dims == dims, (G.dims, dims)
    values = G.to_numpy()
    assert values.dtype.kind in "fi"
    assert np.isfinite(values).all()
    assert values.min() >= least, values.min()
    assert values.max() <= most, values.max()


def require_conductances(G, dims, slack=1e-4):
    """Require conductances that a wire with one subband can have."""
    for name in CONDUCTANCES:
        least, most = (0.0, 4.0) if name in ("G_LL", "G_RR") else (-2.0, 2.0)
        require_numbers(G[name], dims, least - slack, most + slack)
        assert G[name].attrs["units"] == "e^2/h"
    assert all(axis in G.coords for axis in AXES if axis in dims)
