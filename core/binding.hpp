// What the binding files share: arrays as Python hands them to the core, and as it gets them back.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <vector>

#include "leads/self_energy.hpp"
#include "tilted/levels.hpp"

namespace core {

namespace nb = nanobind;

template <class N, int dimensions>
using ArrayIn = nb::ndarray<const N, nb::ndim<dimensions>, nb::c_contig, nb::device::cpu>;
using Vector = ArrayIn<double, 1>;
using Matrix = ArrayIn<double, 2>;
template <class N> using ArrayOf = nb::ndarray<nb::numpy, N, nb::c_contig, nb::device::cpu>;
using Array = ArrayOf<double>;
using ComplexArray = ArrayOf<Amplitude>;

// NumPy makes it, in huge pages where it is large: the system hands out small ones slower than they are filled.
template <class N = double>
inline ArrayOf<N> new_array(const std::vector<size_t>& shape) {
    const char* type = std::is_same_v<N, double> ? "float64" : "complex128";
    return nb::cast<ArrayOf<N>>(nb::module_::import_("numpy").attr("empty")(shape, type));
}

inline std::vector<Wire> wires_of(const Matrix& V, const Matrix& parameters) {
    if (parameters.shape(0) != V.shape(0) || parameters.shape(1) != PARAMETERS)
        throw nb::value_error("parameters must be as many rows as V has, of as many numbers as a wire has parameters");
    return wires_of(int(V.shape(0)), int(V.shape(1)), V.data(), parameters.data());
}

inline void require_shapes(bool fit) {
    if (!fit) throw nb::value_error("the shapes of these arrays do not fit together");
}

inline void take_ends(const Amplitude* from, EndSquare& to) {
    for (int k = 0; k < 64; ++k) to[k / 8][k % 8] = {from[k].real(), from[k].imag()};
    to_majorana(to);
}

// Energies above the axis and the Green's function of isolated ends there, shape (node, 8, 8), as tilted/levels.hpp takes them.
struct EndData {
    std::vector<Complex<double>> z;
    std::unique_ptr<EndSquare[]> F;

    EndData(const ArrayIn<Amplitude, 1>& at, const Amplitude* ends) : F(new EndSquare[at.size()]) {
        for (size_t k = 0; k < at.size(); ++k) {
            z.emplace_back(at.data()[k].real(), at.data()[k].imag());
            take_ends(ends + 64 * k, F[k]);
        }
    }
    std::vector<TiltedLevel> levels() const { return tilted_levels(z.data(), F.get(), int(z.size())); }
};

// What is tested of the core but never called in earnest.
void bind_internals(nb::module_& m);

}  // namespace core
