// What Python sees of the core; solver/_core_baseline.pyi has the same with types.
//
// CORE_VARIANT and CORE_MODULE are set by CMakeLists.txt: this file is compiled once per variant.
// Shapes are checked here; that numbers are within their ranges is for solver/compiled.py's callers.
#include <nanobind/stl/complex.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <condition_variable>
#include <exception>
#include <mutex>

#include "bare.hpp"
#include "binding.hpp"
#include "density.hpp"
#include "derivatives/gradient.hpp"
#include "derivatives/thermal_gradient.hpp"
#include "isolated.hpp"
#include "processor.hpp"
#include "spectrum.hpp"
#include "thermal/conductance.hpp"
#include "tilted/poles.hpp"

namespace nb = nanobind;

#define CORE_TEXT(token) CORE_TEXT_OF(token)
#define CORE_TEXT_OF(token) #token

namespace {

using namespace core;

using Biases = nb::ndarray<const std::int64_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using LeadArray = nb::ndarray<const Amplitude, nb::shape<-1, -1, 2, 2, 2, 2>, nb::c_contig, nb::device::cpu>;
using LeadSlopesArray = nb::ndarray<const Amplitude, nb::shape<-1, -1, 2, 2, 2, 2, 2>, nb::c_contig, nb::device::cpu>;

// Run a computation in threads of its own, and look for Ctrl-C ten times a second.
template <class Work>
void run(Work work) {
    Stop stop;
    std::mutex mutex;
    std::condition_variable changed;
    bool done = false;
    std::exception_ptr failed;
    std::thread thread([&] {
        try {
            work(stop);
        } catch (...) {
            failed = std::current_exception();
        }
        std::lock_guard lock(mutex);
        done = true;
        changed.notify_one();
    });
    bool interrupted = false;
    while (!interrupted) {
        {
            nb::gil_scoped_release release;
            std::unique_lock lock(mutex);
            if (changed.wait_for(lock, std::chrono::milliseconds(100), [&] { return done; })) break;
        }
        interrupted = PyErr_CheckSignals() != 0;
    }
    stop.ask();
    {
        nb::gil_scoped_release release;
        thread.join();
    }
    if (interrupted) throw nb::python_error();
    if (failed) std::rethrow_exception(failed);
}

template <class N = double, class Solve>
ArrayOf<N> on_grid(const Matrix& V, const Matrix& parameters, const Vector& mu, const Vector& B, const Vector& omega,
                   double theta, std::vector<size_t> shape, Solve solve) {
    std::vector<Wire> wires = wires_of(V, parameters);
    Grid grid{wires.data(),  int(wires.size()), mu.data(),     B.data(),         omega.data(),
              int(mu.size()), int(B.size()),    int(omega.size()), theta};
    auto out = new_array<N>(shape);
    run([&](Stop& stop) { solve(grid, out.data(), stop); });
    return out;
}

// From arrays (..., lead, charge, 2, 2).
std::vector<LeadSelfEnergy> lead_self_energies_of(const Amplitude* entry, size_t size) {
    std::vector<LeadSelfEnergy> leads(size / 16);
    for (size_t k = 0; k < size; ++k) leads[k / 16].of[k / 4 % 4](int(k / 2 % 2), int(k % 2)) = entry[k];
    return leads;
}

Array conductance(Matrix V, Matrix parameters, Vector mu, Vector B, Vector omega, double theta, double growth_limit) {
    return on_grid(V, parameters, mu, B, omega, theta, {V.shape(0), mu.size(), B.size(), omega.size(), 2, 4},
                   [&](const Grid& grid, double* out, Stop& stop) { bare_conductance(grid, growth_limit, out, stop); });
}

Array reflection(Matrix V, Matrix parameters, Vector mu, Vector B, double theta, double growth_limit) {
    const double zero = 0.0;
    return on_grid(V, parameters, mu, B, Vector(&zero, {1}), theta, {V.shape(0), 2, mu.size(), B.size()},
                   [&](const Grid& grid, double* out, Stop& stop) { reflection_determinants(grid, growth_limit, out, stop); });
}

nb::tuple thermal(Matrix V, Matrix parameters, Vector mu, Vector B, Vector bias, double kT, double tolerance, double growth_limit) {
    std::vector<size_t> sets{V.shape(0), mu.size(), B.size()};
    Array error = new_array(sets), energies = new_array(sets);
    Array G = on_grid(V, parameters, mu, B, bias, 0.0, {V.shape(0), mu.size(), B.size(), bias.size(), 4},
                      [&](const Grid& grid, double* out, Stop& stop) {
                          thermal_conductance(grid, kT, tolerance, growth_limit, out, error.data(), energies.data(), stop);
                      });
    return nb::make_tuple(G, error, energies);
}

// Of the one wire that there is; slopes are as LeadSelfEnergy, (B, omega, 2) of them.
std::pair<Array, Array> conductance_gradient(Matrix V, Matrix parameters, Vector mu, Vector B, Vector omega, Biases biases,
                                             size_t bias_count, LeadSlopesArray slopes, double spin_orbit_slope,
                                             double growth_limit) {
    require_shapes(V.shape(0) == 1 && biases.shape(0) == omega.size() && slopes.shape(0) == B.size() &&
                   slopes.shape(1) == omega.size());
    for (size_t k = 0; k < biases.size(); ++k) require_shapes(biases.data()[k] < std::int64_t(bias_count));
    Wire wire = wires_of(V, parameters).front();
    std::vector<LeadSelfEnergy> of_leads = lead_self_energies_of(slopes.data(), slopes.size());
    GradientGrid grid{wire,          mu.data(),         B.data(),        omega.data(),    int(mu.size()),  int(B.size()),
                      int(omega.size()), int(bias_count), biases.data(), of_leads.data(), spin_orbit_slope};
    Array by_V = new_array({4, mu.size(), B.size(), bias_count, V.shape(1)});
    Array others = new_array({4, 3, mu.size(), B.size(), bias_count});
    run([&](Stop& stop) { gradient(grid, growth_limit, by_V.data(), others.data(), stop); });
    return {by_V, others};
}

// Of the one wire that there is; slopes are as LeadSelfEnergy, (B, energy, 2) of them.
nb::tuple thermal_conductance_gradient(Matrix V, Matrix parameters, Vector mu, Vector B, Vector bias, double kT, Vector energies,
                                       LeadSlopesArray slopes, double spin_orbit_slope, double tolerance, double growth_limit,
                                       bool roughly) {
    require_shapes(V.shape(0) == 1 && energies.size() == 4 && slopes.shape(0) == B.size() && slopes.shape(1) == 4);
    std::vector<LeadSelfEnergy> of_leads = lead_self_energies_of(slopes.data(), slopes.size());
    std::vector<size_t> sets{mu.size(), B.size()};
    Array error = new_array(sets), solved = new_array(sets), gradient_error = new_array({mu.size(), B.size(), 2});
    Array by_V = new_array({mu.size(), B.size(), bias.size(), 4, V.shape(1)});
    Array others = new_array({mu.size(), B.size(), bias.size(), 4, size_t(roughly ? 0 : CHANGES)});
    Array G = on_grid(V, parameters, mu, B, bias, 0.0, {mu.size(), B.size(), bias.size(), 4},
                      [&](const Grid& grid, double* out, Stop& stop) {
                          ThermalGradientGrid at{grid, kT, energies.data(), of_leads.data(), spin_orbit_slope, roughly};
                          thermal_gradient(at, tolerance, growth_limit, out, error.data(), solved.data(),
                                           {by_V.data(), others.data()}, gradient_error.data(), stop);
                      });
    return nb::make_tuple(G, error, solved, by_V, others, gradient_error);
}

ComplexArray ends_of_isolated(Matrix V, Matrix parameters, Vector mu, Vector B, Vector x, Vector y, double theta) {
    require_shapes(y.size() == x.size());
    return on_grid<Amplitude>(V, parameters, mu, B, x, theta, {V.shape(0), B.size(), mu.size(), x.size(), 8, 8},
                              [&](const Grid& grid, Amplitude* out, Stop& stop) {
                                  isolated_ends(grid, y.data(), out, stop);
                              });
}

Array levels_of(Matrix V, Matrix parameters, Vector mu, Vector B, int count, double theta) {
    return on_grid(V, parameters, mu, B, Vector(), theta, {V.shape(0), mu.size(), B.size(), size_t(count)},
                   [&](const Grid& grid, double* out, Stop& stop) { levels_above_zero(grid, count, out, stop); });
}

// Of the one wire that there is; leads are as LeadSelfEnergy, (B, z) of them.
std::pair<ComplexArray, Array> green_of_sites(Matrix V, Matrix parameters, Vector mu, Vector B, Vector x, Vector y,
                                              LeadArray leads, double theta) {
    require_shapes(V.shape(0) == 1 && y.size() == x.size() && leads.shape(0) == B.size() && leads.shape(1) == x.size());
    Array growth = new_array({mu.size(), B.size(), x.size()});
    std::vector<LeadSelfEnergy> of_leads = lead_self_energies_of(leads.data(), leads.size());
    auto G = on_grid<Amplitude>(V, parameters, mu, B, x, theta, {mu.size(), B.size(), x.size(), V.shape(1), 2},
                                [&](const Grid& grid, Amplitude* out, Stop& stop) {
                                    local_green(grid, y.data(), of_leads.data(), out, growth.data(), stop);
                                });
    return {G, growth};
}

// Of the first wire, shape (energy, lead, charge, 2, 2), in meV.
ComplexArray lead_self_energies(Matrix V, Matrix parameters, double B, Vector omega, double theta) {
    require_shapes(V.shape(0) > 0);
    Wire wire = wires_of(V, parameters).front();
    auto out = new_array<Amplitude>({omega.size(), 2, 2, 2, 2});
    for (size_t e = 0; e < omega.size(); ++e) {
        double w = omega.data()[e];
        LeadSelfEnergy sigma = theta == 0 ? self_energy_of_leads(wire, B, w) : tilted_self_energy_of_leads(wire, B, w, theta);
        for (size_t k = 0; k < 16; ++k) out.data()[16 * e + k] = sigma.of[k / 4](k / 2 % 2, k % 2);
    }
    return out;
}

// The weights of a smooth function's values at the plan's nodes ω_k, then −ω_k, in its thermal averages, shape
// (bias, 2·node).
Array thermal_weights(Vector bias, double kT, int nodes) {
    EnergyPlan plan(bias.data(), int(bias.size()), kT, nodes, Reach::WINDOW);
    Array out = new_array({bias.size(), 2 * size_t(nodes)});
    for (size_t v = 0; v < bias.size(); ++v) std::copy_n(plan.weights[v].begin(), 2 * nodes, out.data() + v * 2 * nodes);
    return out;
}

// The same in the polynomial through them, at energies u in units of the window, shape (u, 2·node).
Array interpolation_weights(Vector u, int nodes) {
    Array out = new_array({u.size(), 2 * size_t(nodes)});
    const Interpolation polynomial = chebyshev_nodes(nodes);
    for (size_t k = 0; k < u.size(); ++k) {
        double* weights = std::fill_n(out.data() + k * 2 * nodes, 2 * nodes, 0.0) - 2 * nodes;
        polynomial.add(u.data()[k], 1.0, weights);
    }
    return out;
}

// Of sets with the same leads, from G of the isolated wires' ends, shape (set, node, 8, 8): poles and their residues, shapes
// (set, pole) and (set, pole, 4), filled up by poles of no residue; a residue that is NaN where there is no model.
std::pair<ComplexArray, ComplexArray> poles_of_tilted(ArrayIn<Amplitude, 1> z, ArrayIn<Amplitude, 4> F, ArrayIn<Amplitude, 2> sigma,
                                                      ArrayIn<Amplitude, 2> slope, double hop, double window) {
    require_shapes(F.shape(1) == z.size() && F.shape(2) == 8 && F.shape(3) == 8 && sigma.size() == 64 && slope.size() == 64);
    EndSquare at_zero, by_energy;
    take_ends(sigma.data(), at_zero), take_ends(slope.data(), by_energy);
    const TiltedLeads leads(at_zero, by_energy);
    std::vector<std::vector<TiltedPole>> found(F.shape(0));
    run([&](Stop& stop) {
        in_parallel(int(found.size()), stop, [&](int set) {
            const EndData data(z, F.data() + set * z.size() * 64);
            if (!tilted_poles(data.levels(), leads, hop, window, found[set]))
                found[set].assign(1, {{0.0, -window}, {NAN, NAN, NAN, NAN}});
        });
    });
    size_t most = 1;
    for (const auto& poles : found) most = std::max(most, poles.size());
    auto poles = new_array<Amplitude>({found.size(), most}), residues = new_array<Amplitude>({found.size(), most, 4});
    for (size_t n = 0; n < found.size() * most; ++n) {
        const auto& of = found[n / most];
        const TiltedPole pole = n % most < of.size() ? of[n % most] : TiltedPole{{0.0, -window}, {}};
        poles.data()[n] = pole.z;
        std::copy(pole.residue, pole.residue + 4, residues.data() + 4 * n);
    }
    return {poles, residues};
}

ComplexArray trigamma_of(ArrayIn<Amplitude, 2> z) {
    auto out = new_array<Amplitude>({z.shape(0), z.shape(1)});
    for (size_t k = 0; k < z.size(); ++k) {
        Complex<double> psi = trigamma(Complex<double>(z.data()[k].real(), z.data()[k].imag()));
        out.data()[k] = {psi.re, psi.im};
    }
    return out;
}

}  // namespace

NB_MODULE(CORE_MODULE, m) {
    m.attr("TOLERANCE") = core::TOLERANCE;
    m.attr("FLOOR") = core::FLOOR;
    m.attr("REACH") = core::REACH;
    m.attr("BELOW_GAP") = core::BELOW_GAP;
    m.attr("NODES") = std::vector<int>(std::begin(core::NODES), std::end(core::NODES));
    m.attr("COMPARED") = core::COMPARED;
    m.attr("GROWTH_LIMIT") = core::GROWTH_LIMIT;
    m.def("instruction_set", [] { return CORE_TEXT(CORE_VARIANT); });
    m.def("supported_variants", &core::supported_variants);
    m.def("set_threads", [](int count) { return core::thread_count().exchange(std::max(1, count)); }, nb::arg("count"));
    m.def("conductance", &conductance, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"), nb::arg("omega"),
          nb::arg("theta"), nb::arg("growth_limit"));
    m.def("reflection_determinant", &reflection, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"),
          nb::arg("theta"), nb::arg("growth_limit"));
    m.def("thermal_conductance", &thermal, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"),
          nb::arg("bias"), nb::arg("kT"), nb::arg("tolerance"), nb::arg("growth_limit"));
    m.def("conductance_gradient", &conductance_gradient, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"),
          nb::arg("omega"), nb::arg("biases"), nb::arg("bias_count"), nb::arg("slopes"), nb::arg("spin_orbit_slope"),
          nb::arg("growth_limit"));
    m.def("thermal_conductance_gradient", &thermal_conductance_gradient, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"),
          nb::arg("B"), nb::arg("bias"), nb::arg("kT"), nb::arg("energies"), nb::arg("slopes"), nb::arg("spin_orbit_slope"),
          nb::arg("tolerance"), nb::arg("growth_limit"), nb::arg("roughly"));
    m.def("isolated_ends", &ends_of_isolated, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"),
          nb::arg("B"), nb::arg("x"), nb::arg("y"), nb::arg("theta"));
    m.def("levels", &levels_of, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"), nb::arg("count"),
          nb::arg("theta"));
    m.def("local_green", &green_of_sites, nb::arg("V"), nb::arg("parameters"), nb::arg("mu"), nb::arg("B"), nb::arg("x"),
          nb::arg("y"), nb::arg("leads"), nb::arg("theta"));
    m.def("lead_self_energies", &lead_self_energies, nb::arg("V"), nb::arg("parameters"), nb::arg("B"), nb::arg("omega"),
          nb::arg("theta"));
    m.def("thermal_weights", &thermal_weights, nb::arg("bias"), nb::arg("kT"), nb::arg("nodes"));
    m.def("interpolation_weights", &interpolation_weights, nb::arg("u"), nb::arg("nodes"));
    m.def("trigamma", &trigamma_of, nb::arg("z"));
    m.def("tilted_poles", &poles_of_tilted, nb::arg("z"), nb::arg("F"), nb::arg("sigma"), nb::arg("slope"), nb::arg("hop"),
          nb::arg("window"));
    nb::module_ internals = m.def_submodule("internals", "What is tested of the core but never called in earnest.");
    core::bind_internals(internals);
}
