"""One test per equation or stated formula of the paper, in its order."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from disorder_landscape import ArgumentError, Nanowire, conductance, topological_visibility
from disorder_landscape.config import load_config
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.model import disorder, hamiltonian
from disorder_landscape.model.parameters import BOLTZMANN
from disorder_landscape.solver import kwant_reference
from disorder_landscape.solver.energy_grid import thermal_grid

WIRE = Nanowire(np.zeros(300))


def test_stated_parameters():
    """S-I: m* = 0.03, α = 8 meV nm, γ = 0.15, Δ₀ = 0.12, g = 25, a = 10 nm, L = 3 µm."""
    assert (WIRE.mass, WIRE.alpha, WIRE.gamma, WIRE.delta0) == (0.03, 8.0, 0.15, 0.12)
    assert (WIRE.g, WIRE.lattice, WIRE.sites * WIRE.lattice) == (25.0, 10.0, 3000.0)
    assert WIRE.barrier == (15.0, 15.0)
    assert WIRE.hopping == pytest.approx(12.69994, abs=1e-5)


def test_equation_S1_dispersion():
    """Eq. S1: at long wavelength ħ²k²/2m* − μ ± αk on τz, at B = 0 and far from pairing."""
    k, mu = 1e-3, 0.3  # 1/nm
    onsite = hamiltonian.lead_onsite(WIRE, 0.0) + (WIRE.lead_mu - mu) * hamiltonian.TAU_Z
    hop = hamiltonian.lead_hopping(WIRE) * np.exp(1j * k * WIRE.lattice)
    bands = np.linalg.eigvalsh(onsite + hop + hop.conj().T)
    kinetic = WIRE.hopping * (WIRE.lattice * k) ** 2
    electron = [kinetic - mu - WIRE.alpha * k, kinetic - mu + WIRE.alpha * k]
    assert_allclose(bands, sorted([*electron, *(-np.array(electron))]), rtol=1e-4)


def test_equation_S1_zeeman():
    """Eq. S1: ½gμ_B B σx at θ = 0."""
    H = hamiltonian.onsite(WIRE, np.zeros(1), 0.0, 1.0, 0.0) - hamiltonian.onsite(
        WIRE, np.zeros(1), 0.0, 0.0, 0.0
    )
    assert_allclose(H[0], 0.5 * 25 * 0.05788382 * hamiltonian.SIGMA_X, rtol=1e-6)


def test_equation_S1_sign_of_the_disorder():
    """Eq. S1: V_dis enters as −µ + V."""
    raised = Nanowire(np.full(20, 0.1))
    lowered_mu = conductance(Nanowire(np.zeros(20)), 0.2, 0.3, 0.01, temperature=0)
    with_V = conductance(raised, 0.3, 0.3, 0.01, temperature=0)
    for name in with_V.data_vars:
        assert_allclose(with_V[name], lowered_mu[name], atol=1e-12)


def test_self_energy():
    """S-I: Σ(ω) = −γ(ω + Δ₀τx)/√(Δ₀² − ω²)."""
    omega = 0.05
    expected = -0.15 * (omega * np.eye(4) + 0.12 * hamiltonian.TAU_X) / np.sqrt(0.12**2 - omega**2)
    assert_allclose(hamiltonian.self_energy(WIRE, omega), expected)


def test_btk_relations():
    """S-I: G_aa = N − R_ee + R_he, G_ab = T_ee − T_he, from the scattering matrix itself."""
    wire = Nanowire(np.random.default_rng(0).normal(0, 0.3, 60))
    arguments = np.array([0.1]), np.array([0.6]), np.array([0.03])
    S = next(kwant_reference.scattering_matrices(wire, *arguments))[1]
    p = {
        (a, e, b, f): (abs(S.submatrix((a, e), (b, f))) ** 2).sum()
        for a in (0, 1)
        for b in (0, 1)
        for e in (0, 1)
        for f in (0, 1)
    }
    G = conductance(wire, 0.1, 0.6, 0.03, temperature=0)
    assert_allclose(G.G_LL.item(), 2 - p[0, 0, 0, 0] + p[0, 1, 0, 0], atol=1e-9)
    assert_allclose(G.G_RR.item(), 2 - p[1, 0, 1, 0] + p[1, 1, 1, 0], atol=1e-9)
    assert_allclose(G.G_RL.item(), p[1, 0, 0, 0] - p[1, 1, 0, 0], atol=1e-9)
    assert_allclose(G.G_LR.item(), p[0, 0, 1, 0] - p[0, 1, 1, 0], atol=1e-9)


def test_thermal_convolution():
    """S-I: the T = 0 conductance convolved with the derivative of a Fermi function."""
    bias, kT = np.array([-0.04, 0.0, 0.01]), BOLTZMANN * 0.05

    def G0(omega):
        return 1 / (1 + (omega - 0.012) ** 2 / 0.01**2)

    omega, weights = thermal_grid(bias, 0.05, 0.12, spacing=1e-4)
    ours = np.einsum("vks,ks->v", weights, np.stack([G0(omega), G0(-omega)], axis=-1))
    for V, value in zip(bias, ours, strict=True):
        integral = quad(
            lambda w, V=V: G0(w) / (4 * kT) / np.cosh((w - V) / (2 * kT)) ** 2,
            V - 30 * kT,
            V + 30 * kT,
            points=[V, 0.012],
            epsabs=1e-10,
        )[0]
        assert value == pytest.approx(integral, abs=2e-5)
    assert_allclose(weights.sum(axis=(1, 2)), 1.0)


@pytest.mark.parametrize(
    "wrong", [{"wire": None}, {"energy_spacing": 0.5}, {"mu": 10**400}, {"B": None}, {"solver": ""}]
)
def test_wrong_arguments_are_one_sentence(wrong):
    arguments = {"wire": Nanowire(np.zeros(10)), "mu": 0.0, "B": 0.3, **wrong}
    with pytest.raises(ArgumentError, match=r"^Argument .* must .*, but .*\.$"):
        conductance(**arguments)


def test_a_lead_without_a_chemical_potential_is_refused():
    with pytest.raises(ArgumentError, match="lead_mu"):
        Nanowire(np.zeros(10), lead_mu=None)


def test_topological_visibility_is_the_determinant_of_the_reflection_matrix():
    """S-I: T_IV = det r at ω = 0: real, positive if trivial and negative if topological."""
    arguments = np.array([0.1]), np.array([0.5]), np.zeros(1)
    r = next(kwant_reference.scattering_matrices(WIRE, *arguments))[1].submatrix(0, 0)
    determinant = np.linalg.det(r)
    assert abs(determinant.imag) < 1e-9
    T = topological_visibility(WIRE, 0.1, [0.0, 0.5]).sel(lead="L", mu=0.1)
    assert T[1].item() == pytest.approx(determinant.real, abs=1e-8)
    assert T[1] < 0 < T[0]


def test_disorder_noise_and_kernel():
    """S-II.1: Gaussian noise of 1.5 meV per site, convolved with a Gaussian of 3 sites."""
    k = disorder.kernel()
    assert k.sum() == pytest.approx(1.0)
    assert k[disorder.KERNEL_REACH + 3] / k[disorder.KERNEL_REACH] == pytest.approx(np.exp(-1))
    rng = np.random.default_rng(0)
    V = np.array([disorder.smooth_noise(rng, 300) for _ in range(400)])
    assert V.std() == pytest.approx(1.5 * np.sqrt(k @ k), rel=0.02)
    distant = (V[:, 0] * V[:, 3]).mean() / (V**2).mean()
    assert distant == pytest.approx(np.exp(-(3**2) / (2 * 3**2)), abs=0.1)


@pytest.mark.parametrize(("amplitude", "std"), [("double", 2.0), ("sum", 1.0)])
def test_amplitudes(amplitude, std):
    assert disorder.kernel(amplitude=amplitude).sum() == pytest.approx(std)


def test_unit_variance_amplitude_is_the_stated_one_after_smoothing():
    rng = np.random.default_rng(0)
    V = [disorder.smooth_noise(rng, 300, amplitude="unit-variance") for _ in range(200)]
    assert np.std(V) == pytest.approx(1.5, rel=0.03)


def test_cosine_transform_and_its_inverse():
    """S-II.1: c₁ … c_n of a discrete cosine transform, of which only the lowest are kept."""
    rng = np.random.default_rng(1)
    labels, V = disorder.disorder_realization(rng, 5, 300)
    c = disorder.cosine_components(V)
    assert_allclose(c[1:6], labels, atol=1e-12)
    assert_allclose(c[6:], 0, atol=1e-12)
    i = np.arange(300)
    assert_allclose(c[2], np.sqrt(2 / 300) * V @ np.cos(np.pi * 2 * (i + 0.5) / 300), atol=1e-12)
    noise = disorder.smooth_noise(np.random.default_rng(1), 300)
    assert_allclose(disorder.cosine_components(noise)[1:6], labels)


def test_the_mean_shift_has_ten_microvolts():
    """S-II.1: "the effective 0th component induces a random μ shift with std of 0.01 meV"."""
    rng = np.random.default_rng(2)
    means = [disorder.disorder_realization(rng, 5, 300)[1].mean() for _ in range(4000)]
    assert np.std(means) == pytest.approx(0.01, rel=0.04)


def test_Y_vector():
    """S-II.1: Y = (c₁ … c_n, α), α uniform between 6.4 and 9.6."""
    config = load_config("configs/smoke.toml").dataset
    drawn = [realization(config, i) for i in range(500)]
    alphas = np.array([one.alpha for one in drawn])
    assert 6.4 <= alphas.min() < 6.45 < 9.55 < alphas.max() <= 9.6
    assert alphas.mean() == pytest.approx(8.0, abs=0.15)
    assert drawn[0].components.shape == (5,)


def test_K_grid():
    """S-II.1: μ from 0 to 0.6 meV and B from 0 to 0.8 T in 15 steps, 5 biases within ±0.04 mV."""
    config = load_config("configs/paper.toml").dataset
    assert_allclose(config.mu, np.linspace(0, 0.6, 15))
    assert_allclose(config.B, np.linspace(0, 0.8, 15))
    assert config.bias == (-0.04, -0.02, 0.0, 0.02, 0.04)
    assert config.realizations == 8000


@pytest.mark.parametrize(
    ("fidelity", "correlation_length", "count"), [(0.95, 3, 54), (0.95, 7, 29), (0.97, 7, 33)]
)
def test_components_required(fidelity, correlation_length, count):
    """S-II.3: 54 components for F = 0.95 at ℓ = 3 sites; 29 and 33 at ℓ = 7 for 0.95 and 0.97."""
    assert disorder.components_required(fidelity, correlation_length, 300) == count
