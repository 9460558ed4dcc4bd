// What the binding files share: arrays as Python hands them to the core, and as it gets them back.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "leads/self_energy.hpp"

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

// What is tested of the core but never called in earnest.
void bind_internals(nb::module_& m);

}  // namespace core
