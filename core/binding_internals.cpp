// For the tests alone: pieces of the core that nothing else calls from Python, in the submodule `internals`.
//
// A list of levels is (E, w): shapes (level,) and (level, 8), a then b of levels.hpp.
#include <nanobind/stl/complex.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "binding.hpp"
#include "thermal/conductance.hpp"
#include "tilted/arithmetic.hpp"

namespace core {

namespace {

using Levelled = std::pair<Array, Array>;
using Squares = ArrayIn<double, 3>;  // (set, row, column)

Levelled as_arrays(const LevelList& levels) {
    Array E = new_array({levels.size()}), w = new_array({levels.size(), 8});
    for (size_t n = 0; n < levels.size(); ++n) {
        E.data()[n] = levels[n].E;
        std::copy(levels[n].w, levels[n].w + 8, w.data() + 8 * n);
    }
    return {E, w};
}

LevelList as_levels(const Vector& E, const Matrix& w) {
    LevelList levels(E.size());
    for (size_t n = 0; n < levels.size(); ++n) {
        levels[n].E = E.data()[n];
        std::copy(w.data() + 8 * n, w.data() + 8 * n + 8, levels[n].w);
    }
    return levels;
}

std::vector<Levelled> levels_of(const std::vector<double>& omega, const std::vector<std::vector<NodeData>>& sets) {
    std::vector<const NodeData*> data;
    for (const auto& set : sets) data.push_back(set.data());
    std::vector<LevelList> levels(sets.size());
    wire_levels(omega.data(), int(omega.size()), data, levels.data());
    std::vector<Levelled> out;
    for (const LevelList& list : levels) out.push_back(as_arrays(list));
    return out;
}

// In complex numbers at all energies.
struct Everywhere : ComplexArithmetic {
    static bool takes(const Wire&, double) { return true; }
};

// Conductances in some arithmetics, each at its own energies, whatever the angle.
template <class... Arithmetic>
Array conductance_in(Matrix V, Matrix parameters, Vector mu, Vector B, Vector omega, double theta, double growth_limit) {
    std::vector<Wire> wires = wires_of(V, parameters);
    Grid grid{wires.data(),   int(wires.size()), mu.data(),         B.data(), omega.data(),
              int(mu.size()), int(B.size()),     int(omega.size()), theta};
    Array out = new_array({wires.size(), mu.size(), B.size(), omega.size(), 2, 4});
    Stop never;
    (bare_conductance<Arithmetic>(grid, growth_limit, out.data(), never), ...);
    return out;
}

// x + yx − x/y and √|x| where x > y, elsewhere 2, of eight numbers each; x and y may lie anywhere.
Array lanes(Vector x, Vector y) {
    Array out = new_array({2, COLUMNS});
    Columns a = Columns::load(x.data()), b = Columns::load(y.data()), sum = a + b * a;
    sum = sum - a * inverse(b);
    sum.store(out.data());
    where_greater(a, b, root(size(a)), Columns(2.0)).store(out.data() + COLUMNS);
    return out;
}

// Diagonal, what is beside it, and the ends' rows, shapes (set, n), (set, n) and (set, n, 8).
std::tuple<Array, Array, Array> as_arrays(const Tridiagonal& T, size_t sets) {
    size_t n = T.diagonal.size();
    Array diagonal = new_array({sets, n}), off = new_array({sets, n}), rows = new_array({sets, n, 8});
    for (size_t s = 0; s < sets; ++s)
        for (size_t k = 0; k < n; ++k) {
            diagonal.data()[s * n + k] = T.diagonal[k][int(s)], off.data()[s * n + k] = T.off[k][int(s)];
            for (int c = 0; c < 8; ++c) rows.data()[(s * n + k) * 8 + c] = T.rows[k][c][int(s)];
        }
    return {diagonal, off, rows};
}

// Of symmetric matrices, and rows that turn along.
std::tuple<Array, Array, Array> tridiagonalise_sets(Squares A, Squares rows) {
    size_t sets = A.shape(0), n = A.shape(1);
    Tridiagonal T;
    T.clear(int(n));
    for (size_t s = 0; s < sets; ++s) {
        Pencil pencil;
        pencil.rank = int(n), pencil.width = padded(int(n));
        pencil.A.assign(n * pencil.width, 0.0);
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j) pencil.A[i * pencil.width + n - 1 - j] = A.data()[(s * n + i) * n + j];
        pencil.rows.assign(rows.data() + s * n * 8, rows.data() + (s + 1) * n * 8);
        tridiagonalise(pencil, T, int(s));
    }
    return as_arrays(T, sets);
}

// What `tridiagonalise` gives, made diagonal.
std::tuple<Array, Array, Array> diagonalise_sets(Matrix diagonal, Matrix off, Squares rows) {
    size_t sets = diagonal.shape(0), n = diagonal.shape(1);
    Tridiagonal T;
    T.clear(int(n));
    for (size_t s = 0; s < sets; ++s)
        for (size_t k = 0; k < n; ++k) {
            T.diagonal[k].set(int(s), diagonal.data()[s * n + k]), T.off[k].set(int(s), off.data()[s * n + k]);
            for (int c = 0; c < 8; ++c) T.rows[k][c].set(int(s), rows.data()[(s * n + k) * 8 + c]);
        }
    if (!diagonalise(T)) throw std::runtime_error("it does not converge");
    return as_arrays(T, sets);
}

// The levels of sets, from G and dG/dω of their ends, shape (set, node, 8, 8), chiral basis.
std::vector<Levelled> levels_from_ends(Vector omega, ArrayIn<double, 4> G, ArrayIn<double, 4> slope) {
    size_t nodes = omega.size();
    std::vector<std::vector<NodeData>> sets(G.shape(0), std::vector<NodeData>(nodes));
    for (size_t s = 0; s < sets.size(); ++s)
        for (size_t k = 0; k < nodes; ++k)
            for (size_t i = 0; i < 64; ++i) {
                size_t from = (s * nodes + k) * 64 + i;
                sets[s][k].G[i / 8][i % 8] = G.data()[from], sets[s][k].slope[i / 8][i % 8] = slope.data()[from];
            }
    return levels_of({omega.data(), omega.data() + nodes}, sets);
}

// The levels that the thermal average finds in each of SETS copies of the first wire.
std::vector<Levelled> levels_of_wire(Matrix V, Matrix parameters, double mu, double B, Vector bias, double kT, int nodes) {
    Wire wire = wires_of(V, parameters).front();
    EnergyPlan plan(bias.data(), int(bias.size()), kT, nodes, Reach::WINDOW);
    SetIndex sets[SETS] = {};
    std::vector<SetData> data(SETS);
    for (SetData& of : data) of.isolated.resize(nodes), of.bare.resize(nodes + COMPARED), of.growth = 0.0;
    detail::solve_nodes(detail::ThermalField(wire, B, plan.omega), plan, &mu, sets, SETS, data.data());
    std::vector<std::vector<NodeData>> isolated;
    for (const SetData& of : data) isolated.push_back(of.isolated);
    return levels_of({plan.omega.begin(), plan.omega.begin() + nodes}, isolated);
}

Array as_array(const std::vector<double>& values) {
    Array out = new_array({values.size()});
    std::copy(values.begin(), values.end(), out.data());
    return out;
}

// At which energies a smooth function is known for its averages over a window that reaches the gap of a wire, below it and
// above, and the weights of its values there and at minus these energies, (bias, energy).
std::tuple<Array, Array, Array> averages_to_gap(Matrix V, Matrix parameters, Vector bias, double kT, int nodes) {
    Wire wire = wires_of(V, parameters).front();
    Reach reach = reach_of(bias.data(), int(bias.size()), kT, wire.delta0);
    EnergyPlan plan(bias.data(), int(bias.size()), kT, nodes, reach, wire.delta0, resolved_up_to(wire, nodes));
    std::vector<double> below(plan.omega.begin(), plan.omega.begin() + nodes), above = plan.above;
    below.insert(below.end(), plan.omega.begin() + nodes + CHECKS, plan.omega.end());
    above.pop_back();
    Array weights = new_array({bias.size(), size_t(plan.smooth_values())});
    for (size_t v = 0; v < bias.size(); ++v)
        std::copy_n(plan.weights[v].begin(), plan.smooth_values(), weights.data() + v * plan.smooth_values());
    return {as_array(below), as_array(above), weights};
}

// w of levels (E, w) once b of the low ones is known from G at ω.
Array complete_low_levels(double omega, Matrix G, Vector E, Matrix w) {
    NodeData at{};
    for (size_t i = 0; i < 64; ++i) at.G[i / 8][i % 8] = G.data()[i];
    LevelList levels = as_levels(E, w);
    detail::complete_low_levels(omega, at, levels);
    return as_arrays(levels).second;
}

// A complex symmetric matrix with its strongest mixings rotated away, and the rotation.
std::pair<ComplexArray, ComplexArray> diagonalise_nearly(ArrayIn<Amplitude, 2> matrix) {
    size_t n = matrix.shape(0);
    detail::NearlyDiagonal H;
    H.resize(int(n));
    for (size_t k = 0; k < n * n; ++k) H.set(int(k / n), int(k % n), matrix.data()[k]);
    H.diagonalise();
    auto rotated = new_array<Amplitude>({n, n}), rotation = new_array<Amplitude>({n, n});
    for (size_t k = 0; k < n * n; ++k) {
        rotated.data()[k] = H.at(int(k / n), int(k % n));
        rotation.data()[k] = H.row_entry(int(k / n), int(k % n));
    }
    return {rotated, rotation};
}

// Where levels (E, w) are densest, in meV.
Array densest(Vector E, Matrix w, double hop, double window) {
    double energies[SOUGHT];
    dense_energies(as_levels(E, w), hop, EnergyPlan(&window, 1, 0.0, NODES[0], Reach::WINDOW), energies);
    Array out = new_array({SOUGHT});
    std::copy(energies, energies + SOUGHT, out.data());
    return out;
}

// Poles z and residues r, shapes (pole,) and (pole, 2, 4).
PoleTerms as_terms(const ArrayIn<Amplitude, 1>& z, const ArrayIn<Amplitude, 3>& r) {
    PoleTerms terms(int(z.size()));
    for (size_t n = 0; n < z.size(); ++n) {
        terms.x[n] = z.data()[n].real(), terms.y[n] = z.data()[n].imag();
        for (size_t k = 0; k < 8; ++k) {
            Amplitude residue = r.data()[8 * n + k];
            terms.re[k / 4][k % 4][n] = residue.real(), terms.im[k / 4][k % 4][n] = residue.imag();
        }
    }
    return terms;
}

// The values of poles at eight energies, shape (4, 8).
Array sum_of_poles(ArrayIn<Amplitude, 1> z, ArrayIn<Amplitude, 3> r, Vector omega) {
    Columns sums[4];
    sum_poles(as_terms(z, r), Columns::load(omega.data()), sums);
    Array out = new_array({4, COLUMNS});
    for (int k = 0; k < 4; ++k) sums[k].store(out.data() + COLUMNS * k);
    return out;
}

// Add the thermal averages of poles to `out`, shape (bias, 4).
void add_averages(ArrayIn<Amplitude, 1> z, ArrayIn<Amplitude, 3> r, Vector bias, double kT,
                  nb::ndarray<double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu> out) {
    average_poles(as_terms(z, r), {bias.data(), bias.data() + bias.size()}, kT, out.data());
}

// Levels E ≥ 0 in a tilted field and what the ends see of them, shapes (level,) and (level, 8), from G of the ends at nodes
// above the axis, shape (node, 8, 8).
std::pair<Array, ComplexArray> tilted_levels_from_ends(ArrayIn<Amplitude, 1> z, ArrayIn<Amplitude, 3> F) {
    const auto levels = EndData(z, F.data()).levels();
    Array E = new_array({levels.size()});
    auto w = new_array<Amplitude>({levels.size(), 8});
    for (size_t n = 0; n < levels.size(); ++n) {
        E.data()[n] = levels[n].E;
        for (int end = 0; end < 8; end += 4) {
            const auto* own = levels[n].w + end;
            const auto on_sites = detail::site_parts<false>(own[0], own[1], own[2], own[3]);
            for (int i = 0; i < 4; ++i) w.data()[8 * n + end + i] = {on_sites.of[i].re, on_sites.of[i].im};
        }
    }
    return {E, w};
}

}  // namespace

void bind_internals(nb::module_& m) {
    m.attr("SETS") = SETS;
    m.attr("COLUMNS") = COLUMNS;
    m.attr("MIXING") = MIXING;
    m.attr("ELSEWHERE") = std::vector<double>(std::begin(ELSEWHERE), std::end(ELSEWHERE));
    m.def("complex_conductance", &conductance_in<Everywhere>);
    m.def("tilted_conductance", &conductance_in<HermitianArithmetic, TiltedArithmetic>);
    m.def("lanes", &lanes);
    m.def("tridiagonalise", &tridiagonalise_sets);
    m.def("diagonalise", &diagonalise_sets);
    m.def("levels_from_ends", &levels_from_ends);
    m.def("levels_of_wire", &levels_of_wire);
    m.def("averages_to_gap", &averages_to_gap);
    m.def("complete_low_levels", &complete_low_levels);
    m.def("diagonalise_nearly", &diagonalise_nearly);
    m.def("dense_energies", &densest);
    m.def("tilted_levels", &tilted_levels_from_ends);
    m.def("sum_poles", &sum_of_poles);
    m.def("average_poles", &add_averages);
}

}  // namespace core
