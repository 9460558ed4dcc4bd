"""The public functions with arguments of every kind: a right answer, or one sentence.

Never another error, a NaN, a warning, or a wait of more than 20 s.
"""

import json
from dataclasses import fields, replace
from importlib import import_module

import numpy as np
import pytest
import xarray as xr
from hypothesis import strategies as st

import disorder_landscape as dl
import disorder_landscape.inference.infer
from disorder_landscape import Nanowire, conductance, conductance_gradient, topological_visibility
from disorder_landscape.config import Config, DatasetConfig
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.inference.optimum import optimum_at
from disorder_landscape.inference.outcome import Outcome
from disorder_landscape.inference.problem.parameters import PARAMETERS
from disorder_landscape.inference.search.few_unknowns import InversionSettings
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.model.quantities import AXES, CONDUCTANCES
from disorder_landscape.model.ranges import BARRIER_RANGE, PARAMETER_RANGES
from odd_arguments import (
    NO_DATASETS,
    Odd,
    answer,
    argument_sets,
    datasets,
    grid,
    number,
    odd_scalars,
    require_conductances,
    require_numbers,
    some_changed,
    tried,
)

USUAL_WIRE = {field.name: field.default for field in fields(Nanowire) if field.name != "potential"}


def wire_arguments(odds=6):
    """Draw what a wire is made of, over the whole range of each parameter and beyond."""
    strategies = {name: number(*ends[:2], odds) for name, ends in PARAMETER_RANGES.items()}
    pair = st.tuples(number(0.0, 30.0, odds), number(*BARRIER_RANGE[:2], odds))
    forms = st.sampled_from([tuple, list, _objects])
    strategies["barrier"] = st.one_of(st.builds(lambda two, to: to(two), pair, forms), number(0, 1))
    usual = {"potential": np.zeros(5), **USUAL_WIRE}
    return st.builds(
        lambda V, others: others | {"potential": V},
        potentials(odds),
        some_changed(usual, strategies),
    )


def _objects(two):
    found = np.empty(len(two), dtype=object)
    for k, one in enumerate(two):
        found[k] = one
    return found


def potentials(odds=6):
    """Draw a potential, and now and then something else."""
    usual = st.one_of(
        st.builds(
            lambda seed, sites, size: size * np.random.default_rng(seed).normal(size=sites),
            st.integers(0, 999),
            st.integers(2, 12),
            st.sampled_from([0.0, 0.1, 1.0, 30.0]),
        ),
        st.lists(st.floats(-5, 5), min_size=2, max_size=4),
        st.sampled_from([np.zeros(40), np.arange(6)[::2], np.ones(2, "f4"), [1000, -1000]]),
    )
    return st.one_of(*[usual] * odds, grid(-1.0, 1.0, 3, 1))


def _wire(arguments):
    try:
        return Nanowire(**arguments)
    except Exception:  # whatever is wrong with it is the test's of the wire
        return Nanowire(np.zeros(3))


def good_wires(dissipation=True):
    """Draw wires that there are."""
    strategies = {
        "alpha": st.floats(0, 30),
        "mass": st.floats(0.01, 0.3),
        "g": st.floats(0, 60),
        "gamma": st.floats(0, 1),
        "delta0": st.floats(0.05, 1),
        "lead_mu": st.floats(0.5, 60),
        "lead_alpha": st.floats(0, 30),
        "barrier": st.tuples(st.floats(0, 50), st.floats(-5, 50)),
    }
    if dissipation:
        strategies["dissipation"] = st.floats(0, 0.1)
    some = some_changed(USUAL_WIRE, strategies)
    V = st.builds(
        lambda seed, sites, size: size * np.random.default_rng(seed).normal(size=sites),
        st.integers(0, 999),
        st.one_of(*[st.integers(2, 8)] * 3, st.integers(2, 40)),
        st.sampled_from([0.0, 0.1, 1.0]),
    )
    return st.builds(lambda V, some: Nanowire(V, **some), V, some)


def wires(dissipation=True):
    """Draw a wire, several, or something else."""
    one = good_wires(dissipation)
    alike = st.builds(
        lambda wire, strengths, to: to(
            [replace(wire, potential=k * wire.potential, alpha=k) for k in strengths]
        ),
        one,
        st.lists(st.floats(0, 2), max_size=3),
        st.sampled_from([list, tuple, iter, lambda w: np.array(w, dtype=object)]),
    )
    unlike = st.lists(one, max_size=2)
    return st.one_of(*[one] * 12, *[alike] * 3, unlike, odd_scalars(), st.just([Nanowire]))


def of_wire(drawn, usual, odd):
    """Draw a wire, and other arguments of a call."""
    return st.builds(lambda wire, some: {"wire": wire} | some, drawn, some_changed(usual, odd))


def is_one(wire):
    return isinstance(wire, Nanowire)


def leading(wire):
    return () if is_one(wire) else ("realization",)


@argument_sets(300)
def test_a_wire_is_made_or_refused(count):
    def check(arguments):
        wire = answer(lambda: Nanowire(**arguments))
        if wire is not None:
            assert wire.sites >= 2
            numbers = [getattr(wire, name) for name in PARAMETER_RANGES]
            numbers = [0.0 if one is None else one for one in numbers]
            assert all(type(one) is float for one in [*numbers, *wire.barrier])
            assert not np.isnan(numbers).any()
            assert np.isfinite([*wire.potential, wire.alpha, *wire.barrier]).all()
            assert wire.potential.dtype == np.float64
            assert np.isfinite(wire.potential_with_barriers).all()

    tried(count, wire_arguments(), check)


def conductance_arguments():
    """Draw arguments of `conductance`."""
    temperature = st.one_of(
        *[st.sampled_from([0, 0.02, 0.05, 0.07])] * 3, number(0.0, 1.0), number(1e-4, 10.0)
    )
    odd = {
        "mu": grid(-1.0, 30.0),
        "B": grid(-2.0, 5.0),
        "bias": st.one_of(grid(-0.06, 0.06, 3), grid(-0.12, 0.12), number(0.0, 1.0, 1)),
        "temperature": temperature,
        "solver": st.sampled_from(["fast", "fast", "Fast", "", None, 3, ["fast"], "k"]),
        "energy_spacing": st.one_of(st.none(), number(1e-4, 1e-2)),
        "progress": st.sampled_from([None, lambda done, total: None, 3, "x", print]),
        "theta": st.one_of(st.just(0), number(-7.0, 7.0)),
    }
    usual = {"mu": 0.1, "B": [0.0, 0.4], "bias": [-0.02, 0.03]}
    return of_wire(wires(), usual, odd)


@argument_sets(150)
def test_conductance_answers_or_refuses(count):
    def check(arguments):
        G = answer(lambda: conductance(**{**arguments, "progress": _quiet(arguments)}))
        if G is not None:
            dims = *leading(arguments["wire"]), *AXES
            require_conductances(G, dims, 1e-4 + float(G["error"].max() if "error" in G else 0))
            if "error" in G:
                require_numbers(G["error"], dims[:-1], 0.0)
                require_numbers(G["energies"], dims[:-1], 1)

    tried(count, conductance_arguments(), check)


def _quiet(arguments):
    progress = arguments.get("progress")
    return None if progress is print else progress


def where_slopes_are():
    """Return strategies for chemical potentials, fields and biases below the gap."""
    bias = st.one_of(grid(-0.06, 0.06, 3), grid(-0.12, 0.12))
    return {"mu": grid(-1.0, 30.0), "B": grid(-2.0, 5.0), "bias": bias}


@argument_sets(150)
def test_conductance_gradient_answers_or_refuses(count):
    odd = {
        **where_slopes_are(),
        "growth_limit": number(1.0, 1e12, 2),
        "temperature": st.one_of(*[st.just(0.0)] * 3, number(0.02, 0.06, 2)),
        "parameters": st.one_of(st.none(), names(["mu", "g", "V", "no"])),
        "direction": st.one_of(
            st.none(),
            st.dictionaries(st.sampled_from(["mu", "alpha", "V", "no", 3]), number(-1.0, 1.0)),
            odd_scalars(),
        ),
        "weights": st.one_of(st.none(), odd_scalars()),
    }
    usual = {"mu": 0.1, "B": [0.0, 0.4], "bias": [-0.02, 0.03], "temperature": 0.0}
    arguments = of_wire(
        st.one_of(*[good_wires(dissipation=False)] * 9, good_wires(), wires()), usual, odd
    )

    def check(arguments):
        slopes = answer(lambda: conductance_gradient(**arguments))
        if slopes is not None:
            for name, values in slopes.data_vars.items():
                dims = AXES[:2] if "err" in str(name) or name == "energies" else AXES
                require_numbers(values, (*AXES, "site") if str(name).endswith("_dV") else dims)

    tried(count, arguments, check)


def names(some):
    """Draw several names, one, or something else."""
    several = st.lists(st.sampled_from(some), max_size=3)
    forms = st.sampled_from([list, tuple, iter, np.array])
    usual = st.one_of(st.builds(lambda of, to: to(of), several, forms), st.sampled_from(some))
    return st.one_of(*[usual] * 6, odd_scalars())


TENSORS = [[0.1, 0.2], [[0.1, 0.2, 0.3]], np.ones((2, 3), "f4"), np.zeros((2, 0)), ["a"], [[1]]]
TENSORS += [np.full((1, 3), np.nan), np.full(2, np.inf), np.ones((1, 3), "f2"), [8 + 1j], [True]]
TENSORS += [np.array([8.0, 9.0]), np.array([-1.0]), np.array([25.0]), [0.1] * 3, [[[0.1]]], [1e300]]


@argument_sets(60)
def test_differentiable_conductance_answers_or_refuses(count):
    odd = {
        **where_slopes_are(),
        "temperature": number(0.02, 0.06, 2),
        "parameters": names(["V", "alpha", "g", "gamma", "delta0", "critical_field", "mu"]),
    }
    usual = {"mu": 0.1, "B": 0.4, "bias": [-0.02, 0.03], "temperature": 0.05}
    of_three_sites = st.just(Nanowire(np.array([0.1, -0.2, 0.3])))
    drawn = of_wire(st.one_of(*[of_three_sites] * 9, wires()), usual, odd)
    each = st.one_of(*[st.sampled_from(TENSORS)] * 6, odd_scalars())
    values = st.one_of(*[st.lists(each, min_size=1, max_size=1)] * 3, st.lists(each, max_size=3))
    import_module("tensorflow").constant(0.0)  # which takes seconds at first

    def check(arguments):
        some, given = arguments
        operation = answer(lambda: dl.differentiable_conductance(**some))
        if operation is not None:
            G = answer(lambda: operation(*given))
            if G is not None:
                assert G.shape[-1] == len(CONDUCTANCES)
                assert np.isfinite(G.numpy()).all()

    tried(count, st.tuples(drawn, values), check)


@argument_sets(300)
def test_a_prior_is_made_or_refused(count):
    beliefs = {
        one.name: st.one_of(
            number(one.low, one.high),
            st.tuples(number(one.low, one.high), number(one.low, one.high)),
            st.tuples(number(one.low, one.high), number(0.0, 1.0)).map(lambda of: ("normal", *of)),
            st.just({"mean": one.usual, "std": 0.01}),
            st.none(),
        )
        for one in PARAMETERS
    }
    odd = beliefs | {
        "components": st.one_of(st.none(), st.integers(1, 9), odd_scalars()),
        "sites": st.one_of(st.integers(2, 40), odd_scalars()),
        "correlation_length": number(1e-3, 100.0),
        "amplitude": number(1e-6, 1e3),
        "mean_std": number(1e-9, 1e3),
        "mass": number(0.001, 1.0),
        "lattice": number(1.0, 100.0),
        "lead_mu": number(0.5, 60.0),
    }

    def made(arguments):
        normal = {
            name: dl.Normal(*of[1:])
            for name, of in arguments.items()
            if isinstance(of, tuple) and len(of) == 3
        }
        return dl.Prior(**(arguments | normal))

    def check(arguments):
        prior = answer(lambda: made(arguments))
        if prior is not None:
            assert dl.Prior.from_mapping(prior.to_dict()) == prior
            assert np.isfinite([*prior.known.values()]).all() or "critical_field" in prior.known
            for of in prior.unknown.values():
                assert np.isfinite([of.mean, of.std, *of.range]).all()

    tried(count, some_changed({"components": 3, "sites": 20}, odd), check)


@argument_sets(150)
def test_topological_visibility_answers_or_refuses(count):
    odd = {
        "mu": grid(-1.0, 30.0),
        "B": grid(-2.0, 5.0),
        "barrier": st.one_of(st.booleans(), odd_scalars()),
        "solver": st.sampled_from(["fast", "fast", "kwant", "Fast", None, 3, ["fast"]]),
        "theta": number(-7.0, 7.0),
    }
    arguments = of_wire(
        st.one_of(*[good_wires(dissipation=False)] * 3, wires(dissipation=False), wires()),
        {"mu": 0.1, "B": [0.0, 0.4]},
        odd,
    )

    def check(arguments):
        T = answer(lambda: topological_visibility(**arguments))
        if T is not None:
            require_numbers(T, (*leading(arguments["wire"]), "lead", "mu", "B"), -1.001, 1.001)

    tried(count, arguments, check)


@argument_sets(100)
def test_local_density_of_states_answers_or_refuses(count):
    odd = {
        "mu": grid(-1.0, 30.0),
        "B": grid(-2.0, 5.0),
        "energy": grid(-0.3, 0.3, 3),
        "temperature": st.one_of(number(0.0, 1.0, 2), st.sampled_from([0.0, 1e-6, 0.05])),
        "theta": number(-7.0, 7.0),
    }
    usual = {"mu": 0.1, "B": [0.0, 0.4], "energy": [-0.05, 0.12]}
    arguments = of_wire(st.one_of(*[good_wires()] * 9, wires()), usual, odd)

    def check(arguments):
        density = answer(lambda: dl.local_density_of_states(**arguments))
        if density is not None:
            for name in ("LDOS_electron", "LDOS_hole"):
                require_numbers(density[name], ("mu", "B", "energy", "site"), -1e-6)

    tried(count, arguments, check)


@argument_sets(100)
def test_modes_answers_or_refuses(count):
    odd = {
        "mu": number(-1.0, 30.0),
        "B": number(-2.0, 5.0),
        "count": st.one_of(st.integers(-1, 5), odd_scalars()),
        "theta": number(-7.0, 7.0),
    }
    arguments = of_wire(
        st.one_of(*[good_wires(dissipation=False)] * 9, wires()), {"mu": 0.1, "B": 0.4}, odd
    )

    def check(arguments):
        found = answer(lambda: dl.modes(**arguments))
        if found is not None:
            require_numbers(found["level"], ("mode",), 0.0, arguments["wire"].delta0)
            require_numbers(found["wire_weight"], ("mode",), 0.0, 1.0 + 1e-9)
            require_numbers(abs(found["wave_function"]), ("mode", "site", "nambu"), 0.0, 1.0 + 1e-9)
            require_numbers(found["overlap"], (), 0.0, 1.0 + 1e-9)

    tried(count, arguments, check)


@argument_sets(60)
def test_gap_answers_or_refuses(count):
    odd = {
        "mu": grid(-1.0, 30.0),
        "B": grid(-2.0, 5.0),
        "temperature": number(0.001, 0.1, 3),
        "threshold": number(0.0, 1.0),
        "theta": st.one_of(st.just(0), number(-7.0, 7.0)),
    }
    arguments = of_wire(
        st.one_of(*[good_wires(dissipation=False)] * 9, wires()), {"mu": 0.1, "B": [0.0, 0.4]}, odd
    )

    def check(arguments):
        found = answer(lambda: dl.gap(**arguments))
        if found is not None:
            for name in ("E_1", "E_2", "excitation_gap", "transport_gap"):
                values = found[name].fillna(0.0)  # where there is none
                require_numbers(values, (*leading(arguments["wire"]), "mu", "B"), 0.0, 10.0)

    tried(count, arguments, check)


DATASET = DatasetConfig(
    realizations=1, components=2, sites=10, mu_points=3, B_points=3, bias=(-0.03, 0.03)
)
FIXED = DATASET.model_copy(update={"alpha_range": (8.0, 8.0)})


class FirstNumbers:
    """Instead of a network: the first numbers of its input."""

    def predict_on_batch(self, x):
        return x.reshape(len(x), -1)[:, :3]

    def get_weights(self):
        return []


LABELS = LabelScaler(("c_1", "c_2", "alpha"), np.zeros(3), np.ones(3))
MODEL = TrainedModel(FirstNumbers(), LABELS, None, Config(dataset=DATASET))
TRUE = realization(DATASET, 0).wire
MEASURED = conductance(TRUE, DATASET.mu, DATASET.B, DATASET.bias)
WIRES = conductance([TRUE, TRUE], DATASET.mu, DATASET.B, DATASET.bias)
LARGER = conductance(TRUE, np.linspace(0, 0.6, 5), np.linspace(0, 0.8, 3), [-0.03, 0.0, 0.03])
NO_MODELS = [None, 3, "", "nowhere", ".", b"x", Odd(), "a" * 300, "a" * 5000, "/dev/null", "\0"]
NO_MODELS += [["a"], np.array(["a"]), Config(dataset=DATASET)]


@argument_sets(150)
def test_predict_answers_or_refuses(count):
    model = st.one_of(*[st.just(MODEL)] * 9, st.sampled_from(NO_MODELS))
    arguments = st.tuples(model, datasets([MEASURED, MEASURED, WIRES, LARGER]))

    def check(arguments):
        Y = answer(lambda: dl.predict(*arguments))
        if Y is not None:
            dims = {dim for name in CONDUCTANCES for dim in arguments[1][name].dims}
            first = ("realization",) if "realization" in dims else ()
            require_numbers(Y["components"], (*first, "component"))
            require_numbers(Y["potential"], (*first, "site"))
            require_numbers(Y["alpha"], first)

    tried(count, arguments, check)


def one_optimum(observation, *others):
    """Instead of an inversion: the prior's mean, with its covariance made smaller."""
    prior = observation.unknowns.white_noise
    answer = replace(prior, covariance=1e-4 * prior.covariance)
    return Outcome([optimum_at(observation, answer)])


@pytest.fixture
def short(monkeypatch):
    """Let no inversion be carried out."""
    monkeypatch.setattr(disorder_landscape.inference.infer, "invert", one_optimum)


PRIOR = dl.Prior(2, 10, g=(20, 30), bias_offset=dl.Normal(0, 1e-3), dissipation=(0, 1e-3))
OF_POSTERIOR = {"g": (), "bias_offset": (), "dissipation": ()}
OF_POSTERIOR |= {"components": ("component",), "potential": ("site",), "alpha": ()}
NOISES = [None, 0.0, 0.01, 1.0, dict.fromkeys(CONDUCTANCES, 0.01), {"G_LL": 0.1}, {}, {1: 2}]
NOISES += [dict.fromkeys(CONDUCTANCES, "x"), dict.fromkeys(CONDUCTANCES, np.nan), {None: 0.1}]
NOISES += [dict.fromkeys([*CONDUCTANCES, "x"], 0.1), {key: [0.1] for key in CONDUCTANCES}]


@argument_sets(50)
def test_infer_answers_or_refuses(count, short):
    odd = {
        "prior": st.sampled_from(NO_MODELS),
        "noise": st.one_of(st.sampled_from(NOISES), number(0.0, 1.0)),
        "network": st.one_of(st.booleans(), st.just(MODEL), odd_scalars()),
        "samples": st.one_of(st.sampled_from([2, 4, 3, 1, 0, 4.0, "4"]), odd_scalars()),
        "seed": st.one_of(st.sampled_from([0, 7, -1, 2**31, 2**32, 2.5]), odd_scalars()),
        "settings": st.sampled_from([None, InversionSettings(attempts=1), 3, "x", {}]),
        "discrepancy": st.one_of(st.booleans(), odd_scalars()),
        "checkpoint": st.sampled_from([None, "nowhere.json", 3, b"x", "a" * 300, "/dev/null/x"]),
        "progress": st.sampled_from([print, None, 3]),
    }
    others = [MODEL, replace(MODEL, config=Config(dataset=FIXED)), PRIOR]
    usual = st.builds(
        lambda G, model, some: {"G": G, "prior": model} | some,
        datasets([MEASURED, MEASURED, LARGER]),
        st.sampled_from(others),
        some_changed({"samples": 4}, odd),
    )

    def check(arguments):
        R = answer(lambda: dl.infer(**arguments))
        if R is not None:
            unknown = [name for name in OF_POSTERIOR if name in R.variables]
            assert "potential" in unknown
            for name, dims in {name: OF_POSTERIOR[name] for name in unknown}.items():
                require_numbers(R[name], ("sample", *dims))
                require_numbers(R[f"{name}_mean"], dims)
                require_numbers(R[f"{name}_std"], dims, 0.0)
            require_conductances(R, AXES)
            require_numbers(R["T_IV"], ("lead", "map_mu", "map_B"), -1.001, 1.001)
            require_numbers(R["P_topological"], ("map_mu", "map_B"), 0.0, 1.0)
            if "discrepancy" in R:
                measured = R["discrepancy"][np.isfinite(R["misfit"])]
                require_numbers(measured, ("channel",), 0.0)
            measured = [name in arguments["G"] for name in CONDUCTANCES]
            assert (np.isfinite(R["misfit"]) <= measured).all()

    tried(count, usual, check)


PREDICTION = xr.Dataset(
    {
        "potential": ("site", TRUE.potential),
        "components": ("component", np.zeros(2)),
        "alpha": 8.0,
    },
    attrs={"config_hash": DATASET.hash},
)
INVERSION = PREDICTION.assign(
    potential=PREDICTION["potential"].expand_dims(sample=50),
    alpha=PREDICTION["alpha"].expand_dims(sample=50),
    potential_mean=PREDICTION["potential"],
    alpha_mean=8.0,
).assign_attrs(prior=json.dumps(dl.Prior(2, 10, alpha=(6.4, 9.6)).to_dict()))
FURTHER = conductance(TRUE, [0.1], [0.2, 0.5], [0.01])


def _is_not_long(controls):
    """Hundreds of controls are right and take longer than a call may here."""
    return not (type(controls) is int and 100 < controls <= 10_000)


@argument_sets(40)
def test_verify_answers_or_refuses(count):
    measurement = datasets([FURTHER], odds=6)
    several = st.one_of(
        *[measurement] * 6,
        st.lists(measurement, max_size=2),
        st.sampled_from([*NO_DATASETS, iter([FURTHER]), (FURTHER, FURTHER)]),
    )
    odd = {
        "measurements": several,
        "noise": st.one_of(st.sampled_from(NOISES), number(0.0, 1.0)),
        "controls": st.one_of(
            st.sampled_from([19, 20, 18, 0, 19.5, "19"]), odd_scalars().filter(_is_not_long)
        ),
        "seed": st.one_of(st.sampled_from([0, -1, 2**63, 2**64, 0.5]), odd_scalars()),
        "config": st.sampled_from([None, DATASET, FIXED, 3, "x", Config(dataset=DATASET)]),
        "shifts": grid(-0.03, 0.03, 3, 3),
        "progress": st.sampled_from([None, lambda done, total: None, 3]),
    }
    usual = {"measurements": FURTHER, "controls": 19, "shifts": [0.0]}
    arguments = st.builds(
        lambda prediction, some: {"prediction": prediction} | some,
        datasets([PREDICTION, PREDICTION, INVERSION]),
        some_changed(usual, odd),
    )

    def check(arguments):
        found = answer(lambda: dl.verify(**arguments))
        if found is not None:
            require_numbers(found["mismatch"], ("measurement", "channel"), 0.0)
            require_numbers(found["control_mismatch"], ("control", "measurement", "channel"), 0.0)
            require_numbers(found["ratio"], ("measurement", "channel"), 0.0)
            require_numbers(found["score"], (), 0.0)
            require_numbers(found["control_score"], ("control",), 0.0)
            require_numbers(found["shift"], (), -2.0, 2.0)
            require_numbers(found["p_value"], (), 0.0, 1.0)
            assert found.attrs["verdict"].endswith(".")

    tried(count, arguments, check)


# What was found before

WIRE = Nanowire([0.0, 0.1, 0.2])


def measured(**changes):
    """Return a measurement with other variables or coordinates."""
    return MEASURED.assign(**changes)


def infer(G=MEASURED, model=MODEL, **options):
    return dl.infer(G, model, samples=2, **options)


def verify(prediction=PREDICTION, measurements=FURTHER, **options):
    return dl.verify(prediction, measurements, controls=19, **{"shifts": 0.0, **options})


FOUND = {
    # numbers and grids
    "complex number": lambda: conductance(WIRE, 0, 0, temperature=np.complex128(0.1 + 1j)),
    "complex grid": lambda: conductance(WIRE, np.array([0.1 + 1j]), 0),
    "complex potential": lambda: Nanowire(np.array([0.0, 1j])),
    "complex barriers": lambda: Nanowire([0, 0], barrier=np.array([1 + 1j, 2])),
    "masked number": lambda: Nanowire([0, 0], mass=np.ma.masked),
    "masked grid": lambda: topological_visibility(WIRE, np.ma.masked, 0),
    "grid beyond doubles": lambda: conductance(WIRE, [-1.7e308, 1.7e308], 0),
    "long double": lambda: conductance(WIRE, np.array([np.longdouble("1e4000")]), 0),
    "potential of long doubles": lambda: Nanowire(np.full(2, np.longdouble("1e4000"))),
    "number of many digits": lambda: Nanowire([0, 0], alpha=10**5000),
    "whole number of many digits": lambda: verify(seed=10**5000),
    "array for a number": lambda: conductance(WIRE, 0, 0, temperature=np.zeros((3, 3))),
    "ragged barriers": lambda: Nanowire([0, 0], barrier=[1.0, [0.1]]),
    # the simulator
    "solvers": lambda: conductance(WIRE, 0, 0, solver=np.array(["fast", "kwant"])),
    "no wire, but an array": lambda: conductance(np.array(0.0), 0, 0),
    "no progress": lambda: conductance(WIRE, 0, 0, progress=3),
    "hardly any temperature": lambda: conductance(WIRE, 0, 0, temperature=1e-300),
    "least temperature": lambda: conductance(WIRE, 0, 0, temperature=5e-324),
    "hardly any temperature, tilted": lambda: conductance(WIRE, 0, 1, 0, 1e-300, theta=0.1),
    "hardly any g": lambda: conductance(
        Nanowire([0.0, 0.0], alpha=1e-208, g=1e-208, dissipation=1e-208), 0.1, [0.0, 0.4]
    ),
    "hardly any field": lambda: topological_visibility(
        Nanowire(np.zeros(2), alpha=0.0, barrier=(46.7, 0.0)), 0.1, 1e-300, barrier=False
    ),
    "growth limit is a text": lambda: conductance_gradient(WIRE, 0, 0, growth_limit="x"),
    "no growth limit": lambda: conductance_gradient(WIRE, 0, 0, growth_limit=None),
    "barriers, not whether": lambda: topological_visibility(WIRE, 0, 0, barrier=np.zeros(2)),
    "energies far apart, hardly broadened": lambda: dl.local_density_of_states(
        WIRE, 0.1, 0.5, [-0.05, 0.12], 1e-6
    ),
    # models
    "no model": lambda: dl.predict(None, MEASURED),
    "no model to infer with": lambda: infer(model=3),
    "long name of a model": lambda: dl.predict("a" * 300, MEASURED),
    "long name of a model to infer with": lambda: infer(model="a" * 5000),
    # predict
    "no Dataset": lambda: dl.predict(MODEL, None),
    "array for a Dataset": lambda: dl.predict(MODEL, xr.DataArray([0.1])),
    "axes of an index of several": lambda: dl.predict(MODEL, MEASURED.stack(all=AXES)),
    "axis of another dim": lambda: dl.predict(
        MODEL, LARGER.rename(B="x").assign_coords(B=("x", LARGER["B"].to_numpy()))
    ),
    "axis of bytes": lambda: dl.predict(MODEL, measured(bias=[b"-0.03", b"0.03"])),
    "axis of nothing": lambda: dl.predict(MODEL, measured(bias=np.array([None, None]))),
    "axis of dates": lambda: dl.predict(MODEL, measured(bias=np.array([0, 1], "M8[ns]"))),
    "channels of unequal length": lambda: dl.predict(
        MODEL, measured(G_RR=MEASURED["G_RR"].expand_dims(realization=2))
    ),
    "no realization": lambda: dl.predict(MODEL, WIRES.isel(realization=slice(0))),
    "realizations of another variable": lambda: dl.predict(
        MODEL, measured(other=("realization", [1, 2, 3])).assign_coords(realization=[0, 1, 2])
    ),
    "conductances beyond floats": lambda: dl.predict(MODEL, MEASURED * 1e300),
    "conductances of texts": lambda: dl.predict(MODEL, MEASURED.astype("U5")),
    "conductances of words": lambda: dl.predict(MODEL, xr.full_like(MEASURED.astype("U5"), "a")),
    "complex conductances": lambda: dl.predict(MODEL, MEASURED + 1j),
    # series resistance
    "no resistance": lambda: dl.without_series_resistance(MEASURED, None, 0.0),
    "resistances of texts": lambda: dl.without_series_resistance(MEASURED, "much", "little"),
    "resistances of a measurement of words": lambda: dl.without_series_resistance(
        xr.full_like(MEASURED.astype("U5"), "a"), 1.0, 1.0
    ),
    "resistances of no measurement": lambda: dl.without_series_resistance(None, 1.0, 1.0),
    # infer and verify
    "channels of fewer dims": lambda: infer(measured(G_LL=MEASURED["G_LL"].isel(mu=0, drop=True))),
    "axis that has no order": lambda: infer(measured(bias=np.array([None, 1], dtype=object))),
    "complex axis": lambda: infer(measured(bias=np.array([-0.03 + 1j, 0.03 + 1j]))),
    "noise of no channel": lambda: infer(noise={None: 0.1}),
    "ragged noise": lambda: infer(MEASURED.assign_attrs(noise=[1, [2, 3]])),
    "complex barriers of a measurement": lambda: infer(
        MEASURED.assign_attrs(barrier=np.array([15.0 + 1j, 15.0]))
    ),
    "whether is an array": lambda: infer(network=np.array([])),
    "checkpoint is a text": lambda: infer(checkpoint="nowhere/nothing.json"),
    "no settings": lambda: infer(settings="x"),
    "an inversion without its samples": lambda: verify(INVERSION.drop_dims("sample")),
    "complex potentials of an inversion": lambda: verify(
        INVERSION.assign(potential_mean=INVERSION["potential_mean"] + 0j)
    ),
    "no measurement": lambda: verify(measurements=None),
    "number for measurements": lambda: verify(measurements=3),
    "no disorder model": lambda: verify(config=3),
    "no progress of a verification": lambda: verify(progress=3),
    "complex alpha": lambda: verify(PREDICTION.assign(alpha=8.0 + 0j)),
    "alpha is a text": lambda: verify(PREDICTION.assign(alpha="x")),
    "fewer sites than components": lambda: verify(PREDICTION.isel(site=slice(2))),
}


@pytest.mark.parametrize("name", FOUND)
def test_what_was_found_is_answered_or_refused(name, short):
    """… and what is answered holds no NaN."""
    found = answer(FOUND[name])
    if isinstance(found, xr.Dataset | xr.DataArray):
        may_lack = (
            ["misfit", "p_samples"] if name == "an inversion without its samples" else ["misfit"]
        )
        some = found.drop_vars(may_lack, errors="ignore")
        assert all(np.isfinite(v.to_numpy()).all() for v in _numbers(some))


def _numbers(found):
    variables = found.variables.values() if isinstance(found, xr.Dataset) else [found]
    return [one for one in variables if one.dtype.kind in "fi"]
