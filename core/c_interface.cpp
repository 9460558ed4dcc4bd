// What c_interface.h declares: arguments are checked and go to the headers that binding.cpp uses.
#include "c_interface.h"

#include <algorithm>
#include <cstdlib>

#include "bare.hpp"
#include "thermal/conductance.hpp"

#if defined(__wasm__)
// Where libc++ gives up it would say why on a stream, and the module would have to import one.
void std::__libcpp_verbose_abort(const char*, ...) noexcept { __builtin_trap(); }
#endif

namespace {

using namespace core;

static_assert(PARAMETERS == NANOWIRE_PARAMETERS);

bool all_finite(const double* x, size_t count) {
    return std::all_of(x, x + count, [](double value) { return std::isfinite(value); });
}

bool sound(const Wire& w) {
    return w.hopping > 0 && w.delta0 > 0 && w.gamma >= 0 && w.dissipation >= 0 && w.parent_dissipation >= 0;
}

int status_of(bool exact) { return exact ? NANOWIRE_DONE : NANOWIRE_INEXACT; }

// The wires, the grid that points to them, and what is wrong with what they were made of.
struct Request {
    std::vector<Wire> wires;
    Grid grid{};
    int status = NANOWIRE_DONE;

    // omega: energies or biases.
    Request(int count, int sites, const double* V, const double* parameters, int mu_count,
            const double* mu, int B_count, const double* B, int omega_count, const double* omega) {
        if (count < 1 || sites < 2 || mu_count < 1 || B_count < 1 || omega_count < 1) {
            status = NANOWIRE_BAD_COUNT;
            return;
        }
        bool finite = all_finite(V, size_t(count) * sites) &&
                      all_finite(parameters, size_t(count) * PARAMETERS) &&
                      all_finite(mu, mu_count) && all_finite(B, B_count) &&
                      all_finite(omega, omega_count);
        if (!finite) {
            status = NANOWIRE_NOT_FINITE;
            return;
        }
        wires = wires_of(count, sites, V, parameters);
        grid = {wires.data(), count, mu, B, omega, mu_count, B_count, omega_count};
        if (!std::ranges::all_of(wires, sound)) status = NANOWIRE_BAD_WIRE;
    }
    Request(const Request&) = delete;

    size_t points() const { return wires.size() * grid.mu_count * grid.B_count; }
    bool without_dissipation() const {
        return std::ranges::all_of(wires, [](const Wire& w) { return w.dissipation == 0 && w.parent_dissipation == 0; });
    }
    bool evenly_broadened() const {
        return std::ranges::all_of(wires, [](const Wire& w) { return w.dissipation == w.parent_dissipation; });
    }
    bool below_the_gap() const {
        double largest = window_of(grid.omega, grid.omega_count, 0.0);
        return std::ranges::all_of(wires, [&](const Wire& w) { return largest < w.delta0; });
    }
};

}  // namespace

double* nanowire_allocate(int count) noexcept {
    return count < 0 ? nullptr : static_cast<double*>(std::malloc(size_t(count) * sizeof(double)));
}

void nanowire_free(double* room) noexcept { std::free(room); }

int nanowire_conductance(int wires, int sites, const double* V, const double* parameters,
                         int mu_count, const double* mu, int B_count, const double* B,
                         int omega_count, const double* omega, double* G) noexcept {
    Request of(wires, sites, V, parameters, mu_count, mu, B_count, B, omega_count, omega);
    if (of.status != NANOWIRE_DONE) return of.status;
    Stop never;
    bare_conductance(of.grid, GROWTH_LIMIT, G, never);
    return status_of(all_finite(G, of.points() * omega_count * 8));
}

int nanowire_thermal_conductance(int wires, int sites, const double* V, const double* parameters,
                                 int mu_count, const double* mu, int B_count, const double* B,
                                 int bias_count, const double* bias, double kT, double tolerance,
                                 double* G, double* error) noexcept {
    Request of(wires, sites, V, parameters, mu_count, mu, B_count, B, bias_count, bias);
    if (of.status != NANOWIRE_DONE) return of.status;
    if (!std::isfinite(kT) || !std::isfinite(tolerance)) return NANOWIRE_NOT_FINITE;
    if (!of.evenly_broadened()) return NANOWIRE_BAD_WIRE;
    if (!(kT > 0)) return NANOWIRE_BAD_TEMPERATURE;
    if (!of.below_the_gap()) return NANOWIRE_BAD_BIAS;
    Stop never;
    std::vector<double> energies(of.points());
    thermal_conductance(of.grid, kT, tolerance, GROWTH_LIMIT, G, error, energies.data(), never);
    auto exact = [&](double estimate) { return estimate <= tolerance; };
    return status_of(std::all_of(error, error + of.points(), exact));
}

int nanowire_reflection_determinant(int wires, int sites, const double* V, const double* parameters,
                                    int mu_count, const double* mu, int B_count, const double* B,
                                    double* det_r) noexcept {
    const double zero = 0.0;
    Request of(wires, sites, V, parameters, mu_count, mu, B_count, B, 1, &zero);
    if (of.status != NANOWIRE_DONE) return of.status;
    if (!of.without_dissipation()) return NANOWIRE_BAD_WIRE;
    Stop never;
    reflection_determinants(of.grid, GROWTH_LIMIT, det_r, never);
    return status_of(all_finite(det_r, of.points() * 2));
}
