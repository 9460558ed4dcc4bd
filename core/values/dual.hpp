// Numbers that carry a slope: value + slope·ε, ε² = 0.
//
// A formula written for numbers gives with these its derivative, too, at two multiply-adds for each
// multiply-add: no more than slopes written out by hand.
#pragma once

#include "complex.hpp"

namespace core {

template <class N>
struct Dual {
    N value, slope;
    Dual() = default;
    CORE_INLINE Dual(N value, N slope) : value(value), slope(slope) {}
    CORE_INLINE Dual(N value) : value(value), slope(0.0) {}
    CORE_INLINE Dual(double value) : value(value), slope(0.0) {}
    CORE_INLINE Dual operator-() const { return {-value, -slope}; }
};

template <class N> struct IsNumber<Dual<N>> { static constexpr bool value = true, of_lanes = true; };

template <class N> CORE_INLINE Dual<N> plus(Dual<N> a, Dual<N> b) { return {a.value + b.value, a.slope + b.slope}; }
template <class N> CORE_INLINE Dual<N> minus(Dual<N> a, Dual<N> b) { return {a.value - b.value, a.slope - b.slope}; }
template <class N> CORE_INLINE Dual<N> multiply(Dual<N> a, Dual<N> b) {
    return {multiply(a.value, b.value), multiply_add(a.value, b.slope, multiply(a.slope, b.value))};
}
template <class N> CORE_INLINE Dual<N> multiply_add(Dual<N> a, Dual<N> b, Dual<N> c) {
    return {multiply_add(a.value, b.value, c.value),
            multiply_add(a.value, b.slope, multiply_add(a.slope, b.value, c.slope))};
}
template <class N> CORE_INLINE Dual<N> multiply_subtract(Dual<N> a, Dual<N> b, Dual<N> c) {
    return {multiply_subtract(a.value, b.value, c.value),
            multiply_subtract(a.value, b.slope, multiply_subtract(a.slope, b.value, c.slope))};
}
template <class N> CORE_INLINE Dual<N> inverse(Dual<N> a) {
    N over = inverse(a.value);
    return {over, -multiply(multiply(over, over), a.slope)};
}

template <class N> CORE_INLINE auto size(Dual<N> a) { return size(a.value); }
template <class N> CORE_INLINE N value_of(Dual<N> a) { return a.value; }

}  // namespace core
