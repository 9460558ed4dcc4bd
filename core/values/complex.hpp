// Complex numbers over any number type: lanes, or one double.
#pragma once

#include <complex>

#include "lanes.hpp"

namespace core {

template <class R>
struct Complex {
    using Real = R;
    R re, im;
    Complex() = default;
    CORE_INLINE Complex(R re, R im) : re(re), im(im) {}
    CORE_INLINE Complex(R re) : re(re), im(0.0) {}
    CORE_INLINE Complex(double re) requires(!std::is_same_v<R, double>) : re(re), im(0.0) {}
    CORE_INLINE Complex operator-() const { return {-re, -im}; }
};

template <class R> struct IsNumber<Complex<R>> { static constexpr bool value = true, of_lanes = !std::is_same_v<R, double>; };

CORE_INLINE double multiply(double a, double b) { return a * b; }
CORE_INLINE double multiply_add(double a, double b, double c) { return a * b + c; }
CORE_INLINE double multiply_subtract(double a, double b, double c) { return c - a * b; }
CORE_INLINE double inverse(double a) { return 1.0 / a; }
CORE_INLINE double size(double a) { return std::abs(a); }
CORE_INLINE double larger(double a, double b) { return b > a ? b : a; }

template <class R> CORE_INLINE Complex<R> plus(Complex<R> a, Complex<R> b) { return {a.re + b.re, a.im + b.im}; }
template <class R> CORE_INLINE Complex<R> minus(Complex<R> a, Complex<R> b) { return {a.re - b.re, a.im - b.im}; }
template <class R> CORE_INLINE Complex<R> multiply(Complex<R> a, Complex<R> b) {
    return {multiply_subtract(a.im, b.im, multiply(a.re, b.re)), multiply_add(a.im, b.re, multiply(a.re, b.im))};
}
template <class R> CORE_INLINE Complex<R> multiply_add(Complex<R> a, Complex<R> b, Complex<R> c) {
    return {multiply_subtract(a.im, b.im, multiply_add(a.re, b.re, c.re)),
            multiply_add(a.im, b.re, multiply_add(a.re, b.im, c.im))};
}
template <class R> CORE_INLINE Complex<R> multiply_subtract(Complex<R> a, Complex<R> b, Complex<R> c) {
    return {multiply_add(a.im, b.im, multiply_subtract(a.re, b.re, c.re)),
            multiply_subtract(a.im, b.re, multiply_subtract(a.re, b.im, c.im))};
}

// With a real factor.
template <class R> CORE_INLINE Complex<R> multiply(Complex<R> a, R b) { return {multiply(a.re, b), multiply(a.im, b)}; }
template <class R> CORE_INLINE Complex<R> multiply_add(Complex<R> a, R b, Complex<R> c) {
    return {multiply_add(a.re, b, c.re), multiply_add(a.im, b, c.im)};
}
template <class R> CORE_INLINE Complex<R> multiply_subtract(Complex<R> a, R b, Complex<R> c) {
    return {multiply_subtract(a.re, b, c.re), multiply_subtract(a.im, b, c.im)};
}
template <class R> CORE_INLINE Product<Complex<R>, R> operator*(Complex<R> a, R b) { return {a, b}; }
template <class R> CORE_INLINE Product<Complex<R>, R> operator*(R b, Complex<R> a) { return {a, b}; }

// One lane as a number of its own.
template <class R> inline std::complex<double> of_lane(R x, int lane) { return x[lane]; }
template <class R> inline std::complex<double> of_lane(Complex<R> x, int lane) { return {x.re[lane], x.im[lane]}; }
template <class R> inline void set_lane(Complex<R>& x, int lane, std::complex<double> value) {
    x.re.set(lane, value.real());
    x.im.set(lane, value.imag());
}

template <class R> CORE_INLINE Complex<R> conj(Complex<R> a) { return {a.re, -a.im}; }
template <class R> CORE_INLINE R square(Complex<R> a) { return multiply_add(a.im, a.im, multiply(a.re, a.re)); }
template <class R> CORE_INLINE Complex<R> inverse(Complex<R> a) {
    R norm = inverse(square(a));
    return {multiply(a.re, norm), -multiply(a.im, norm)};
}

// |re| + |im|, which is between |a| and √2 |a|.
template <class R> CORE_INLINE R size(Complex<R> a) { return size(a.re) + size(a.im); }

}  // namespace core
