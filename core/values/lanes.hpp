// W doubles as one number: a lane is one energy, one pole or one set of its own.
//
// A lane never sees another one, so results do not depend on W, nor on which lanes go together.  A
// vector of W lanes is held in the widest registers of the processor that the file is compiled for;
// everything that knows processors by name is in this file.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "product.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

namespace core {

#if defined(__AVX512F__)
constexpr int REGISTER = 8;
#elif defined(__AVX2__) && defined(__FMA__)
constexpr int REGISTER = 4;
#else
constexpr int REGISTER = 2;
#endif
// Doubles of one register of the processor.

typedef double Register __attribute__((vector_size(8 * REGISTER)));
typedef long long Mask __attribute__((vector_size(8 * REGISTER)));

namespace hardware {

CORE_INLINE Register all(double x) {
#if defined(__AVX512F__)
    return _mm512_set1_pd(x);
#elif defined(__AVX2__) && defined(__FMA__)
    return _mm256_set1_pd(x);
#else
    return Register{x, x};
#endif
}

CORE_INLINE Register multiply_add(Register a, Register b, Register c) {
#if defined(__AVX512F__)
    return _mm512_fmadd_pd(a, b, c);
#elif defined(__AVX2__) && defined(__FMA__)
    return _mm256_fmadd_pd(a, b, c);
#elif defined(__aarch64__)
    return (Register)vfmaq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
#else  // no multiply-add: two roundings
    return a * b + c;
#endif
}

CORE_INLINE Register multiply_subtract(Register a, Register b, Register c) {
#if defined(__AVX512F__)
    return _mm512_fnmadd_pd(a, b, c);
#elif defined(__AVX2__) && defined(__FMA__)
    return _mm256_fnmadd_pd(a, b, c);
#elif defined(__aarch64__)
    return (Register)vfmsq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
#else
    return c - a * b;
#endif
}

CORE_INLINE Register root(Register a) {
#if defined(__AVX512F__)
    return _mm512_sqrt_pd(a);
#elif defined(__AVX2__) && defined(__FMA__)
    return _mm256_sqrt_pd(a);
#elif defined(__x86_64__)
    return (Register)_mm_sqrt_pd((__m128d)a);
#elif defined(__aarch64__)
    return (Register)vsqrtq_f64((float64x2_t)a);
#elif defined(__wasm_simd128__)
    return (Register)wasm_f64x2_sqrt((v128_t)a);
#else
    for (int l = 0; l < REGISTER; ++l) a[l] = std::sqrt(a[l]);
    return a;
#endif
}

CORE_INLINE Register size(Register a) {
    constexpr long long ALL_BUT_SIGN = 0x7fffffffffffffffLL;
    return (Register)((Mask)a & (Mask{} + ALL_BUT_SIGN));
}

// The larger of both; a where one of them is no number.
CORE_INLINE Register larger(Register a, Register b) {
#if defined(__AVX512F__)
    return _mm512_max_pd(b, a);
#elif defined(__AVX2__) && defined(__FMA__)
    return _mm256_max_pd(b, a);
#elif defined(__x86_64__)
    return (Register)_mm_max_pd((__m128d)b, (__m128d)a);
#else
    return b > a ? b : a;
#endif
}

// Of lanes whose number has the bit SPAN, take b's a bit lower into a, of the others a's into b.
template <int SPAN, int... lane>
CORE_INLINE void exchange(Register& a, Register& b, std::integer_sequence<int, lane...>) {
    Register x = a;
#if defined(__clang__)
    a = __builtin_shufflevector(x, b, (lane & SPAN ? lane - SPAN + REGISTER : lane)...);
    b = __builtin_shufflevector(x, b, (lane & SPAN ? lane + REGISTER : lane + SPAN)...);
#else
    a = __builtin_shuffle(x, b, Mask{(lane & SPAN ? lane - SPAN + REGISTER : lane)...});
    b = __builtin_shuffle(x, b, Mask{(lane & SPAN ? lane + REGISTER : lane + SPAN)...});
#endif
}

}  // namespace hardware

// Exchange rows and lanes: row i then holds lane i of each.
template <int SPAN = 1>
CORE_INLINE void transpose(Register (&rows)[REGISTER]) {
#pragma GCC unroll 8
    for (int i = 0; i < REGISTER; ++i)
        if ((i & SPAN) == 0)
            hardware::exchange<SPAN>(rows[i], rows[i + SPAN], std::make_integer_sequence<int, REGISTER>());
    if constexpr (2 * SPAN < REGISTER) transpose<2 * SPAN>(rows);
}

template <int W>
struct Lanes {
    static_assert(W % REGISTER == 0);
    static constexpr int WIDTH = W;
    static constexpr int REGISTERS = W / REGISTER;
    Register r[REGISTERS];

    Lanes() = default;
    CORE_INLINE Lanes(double x) {
        for (auto& part : r) part = hardware::all(x);
    }

    CORE_INLINE static Lanes load(const double* from) {
        Lanes x;
        for (int i = 0; i < REGISTERS; ++i) std::memcpy(&x.r[i], from + i * REGISTER, sizeof(Register));
        return x;
    }
    CORE_INLINE void store(double* to) const {
        for (int i = 0; i < REGISTERS; ++i) std::memcpy(to + i * REGISTER, &r[i], sizeof(Register));
    }

    CORE_INLINE double operator[](int lane) const { return r[lane / REGISTER][lane % REGISTER]; }
    CORE_INLINE void set(int lane, double x) { r[lane / REGISTER][lane % REGISTER] = x; }

    CORE_INLINE Lanes operator-() const { return each([](Register a) { return -a; }, *this); }

    template <class F, class... Some>
    CORE_INLINE static Lanes each(F f, Some... some) {
        Lanes x;
        for (int i = 0; i < REGISTERS; ++i) x.r[i] = f(some.r[i]...);
        return x;
    }
};

template <int W> struct IsNumber<Lanes<W>> { static constexpr bool value = true, of_lanes = true; };

template <int W> CORE_INLINE Lanes<W> plus(Lanes<W> a, Lanes<W> b) {
    return Lanes<W>::each([](Register x, Register y) { return x + y; }, a, b);
}
template <int W> CORE_INLINE Lanes<W> minus(Lanes<W> a, Lanes<W> b) {
    return Lanes<W>::each([](Register x, Register y) { return x - y; }, a, b);
}
template <int W> CORE_INLINE Lanes<W> multiply(Lanes<W> a, Lanes<W> b) {
    return Lanes<W>::each([](Register x, Register y) { return x * y; }, a, b);
}
template <int W> CORE_INLINE Lanes<W> multiply_add(Lanes<W> a, Lanes<W> b, Lanes<W> c) {
    return Lanes<W>::each(hardware::multiply_add, a, b, c);
}
template <int W> CORE_INLINE Lanes<W> multiply_subtract(Lanes<W> a, Lanes<W> b, Lanes<W> c) {
    return Lanes<W>::each(hardware::multiply_subtract, a, b, c);
}
template <int W> CORE_INLINE Lanes<W> inverse(Lanes<W> a) {
    return Lanes<W>::each([](Register x) { return 1.0 / x; }, a);
}
template <int W> CORE_INLINE Lanes<W> root(Lanes<W> a) { return Lanes<W>::each(hardware::root, a); }
template <int W> CORE_INLINE Lanes<W> size(Lanes<W> a) { return Lanes<W>::each(hardware::size, a); }

// x where a > b, elsewhere, and where one of them is no number, y.
template <int W>
CORE_INLINE Lanes<W> where_greater(Lanes<W> a, Lanes<W> b, Lanes<W> x, Lanes<W> y) {
    return Lanes<W>::each(
        [](Register p, Register q, Register u, Register v) { return p > q ? u : v; }, a, b, x, y);
}

// The larger of both; a where one of them is no number, so that NaN in a stays.
template <int W> CORE_INLINE Lanes<W> larger(Lanes<W> a, Lanes<W> b) {
    return Lanes<W>::each(hardware::larger, a, b);
}

}  // namespace core
