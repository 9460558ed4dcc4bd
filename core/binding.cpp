// What Python sees of the core; solver/_core_baseline.pyi has the same with types.
//
// CORE_VARIANT and CORE_MODULE are set by CMakeLists.txt: this file is compiled once per variant.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <span>

#include "processor.hpp"
#include "values/lanes.hpp"

namespace nb = nanobind;

#define CORE_TEXT(token) CORE_TEXT_OF(token)
#define CORE_TEXT_OF(token) #token

namespace core::CORE_VARIANT {

using Doubles = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

} // namespace core::CORE_VARIANT

NB_MODULE(CORE_MODULE, m) {
    namespace here = core::CORE_VARIANT;
    m.def("instruction_set", [] { return CORE_TEXT(CORE_VARIANT); });
    m.def("supported_variants", &here::supported_variants);
    m.def(
        "sum_of_squares",
        [](const here::Doubles &values) {
            return here::sum_of_squares(std::span(values.data(), values.size()));
        },
        nb::arg("values").noconvert(), nb::call_guard<nb::gil_scoped_release>());
}
