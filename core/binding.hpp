// What the binding files share: arrays as Python hands them to the core, and as it gets them back.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

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

template <class N = double>
inline ArrayOf<N> new_array(std::vector<size_t> shape) {
    size_t size = 1;
    for (size_t n : shape) size *= n;
    auto* data = new N[size];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<N*>(p); });
    return ArrayOf<N>(data, shape.size(), shape.data(), owner);
}

// The columns of `parameters` are those of solver/compiled.py.
inline std::vector<Wire> wires_of(const Matrix& V, const Matrix& parameters) {
    std::vector<Wire> wires;
    for (size_t w = 0; w < V.shape(0); ++w) {
        const double* p = parameters.data() + w * parameters.shape(1);
        wires.push_back({int(V.shape(1)), V.data() + w * V.shape(1), p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8]});
    }
    return wires;
}

// What is tested of the core but never called in earnest.
void bind_internals(nb::module_& m);

}  // namespace core
