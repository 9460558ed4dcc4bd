// Several numbers at once, as many as a register of this variant's CPU holds.
#pragma once

#include <cstddef>
#include <span>

namespace core::CORE_VARIANT {

#if defined(__AVX512F__)
inline constexpr std::size_t width = 8;
#elif defined(__AVX2__)
inline constexpr std::size_t width = 4;
#else
inline constexpr std::size_t width = 2;
#endif

// The sum of the squares, in as many partial sums as there are lanes.
inline double sum_of_squares(std::span<const double> values) {
    double partial[width] = {};
    std::size_t i = 0;
    for (; i + width <= values.size(); i += width) {
        for (std::size_t lane = 0; lane < width; ++lane) {
            partial[lane] += values[i + lane] * values[i + lane];
        }
    }
    double sum = 0.0;
    for (const double part : partial) {
        sum += part;
    }
    for (; i < values.size(); ++i) {
        sum += values[i] * values[i];
    }
    return sum;
}

} // namespace core::CORE_VARIANT
