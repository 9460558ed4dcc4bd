// Products that wait for the sum they belong to.
//
// x * y is a Product; added to a third number it becomes one multiply-add, with one rounding where
// the processor has them.  So each formula says by itself which operations are contracted, and no
// compiler's choice does: compiled with -ffp-contract=off, the same source gives the same bits for
// every processor with multiply-adds.  Never keep a Product in an `auto` variable: it would be
// multiplied anew at each use.
//
// A number type N takes part by multiply(a, b), multiply_add(a, b, c) = c + ab and
// multiply_subtract(a, b, c) = c − ab.
#pragma once

#define CORE_INLINE inline __attribute__((always_inline))

namespace core {

template <class A, class B = A>
struct Product {
    A a;
    B b;
    using Number = decltype(multiply(a, b));
    CORE_INLINE operator Number() const { return multiply(a, b); }
    CORE_INLINE Product operator-() const { return {-a, b}; }
};

template <class N> struct IsNumber { static constexpr bool value = false, of_lanes = false; };
template <class N> concept Number = IsNumber<N>::value;

template <class A, class B, Number N>
CORE_INLINE N operator+(N c, Product<A, B> p) { return multiply_add(p.a, p.b, c); }
template <class A, class B, Number N>
CORE_INLINE N operator+(Product<A, B> p, N c) { return multiply_add(p.a, p.b, c); }
template <class A, class B, Number N>
CORE_INLINE N operator-(N c, Product<A, B> p) { return multiply_subtract(p.a, p.b, c); }
template <class A, class B, Number N>
CORE_INLINE N operator-(Product<A, B> p, N c) { return multiply_add(p.a, p.b, -c); }

template <class A, class B, class C, class D>
CORE_INLINE auto operator+(Product<A, B> p, Product<C, D> q) { return multiply_add(q.a, q.b, multiply(p.a, p.b)); }
template <class A, class B, class C, class D>
CORE_INLINE auto operator-(Product<A, B> p, Product<C, D> q) { return multiply_subtract(q.a, q.b, multiply(p.a, p.b)); }

template <class A, class B, Number N>
CORE_INLINE auto operator*(Product<A, B> p, N c) { return Product<typename Product<A, B>::Number, N>{p, c}; }
template <class A, class B, Number N>
CORE_INLINE auto operator*(N c, Product<A, B> p) { return Product<N, typename Product<A, B>::Number>{c, p}; }

template <Number N> CORE_INLINE Product<N> operator*(N a, N b) { return {a, b}; }
template <Number N> CORE_INLINE N operator+(N a, N b) { return plus(a, b); }
template <Number N> CORE_INLINE N operator-(N a, N b) { return minus(a, b); }
template <Number N, class B> CORE_INLINE N& operator+=(N& a, B b) { return a = a + b; }
template <Number N, class B> CORE_INLINE N& operator-=(N& a, B b) { return a = a - b; }

// Plain doubles stand for themselves in every lane.
template <Number N> CORE_INLINE Product<N> operator*(double a, N b) requires IsNumber<N>::of_lanes { return {N(a), b}; }
template <Number N> CORE_INLINE Product<N> operator*(N a, double b) requires IsNumber<N>::of_lanes { return {a, N(b)}; }
template <Number N> CORE_INLINE N operator+(double a, N b) requires IsNumber<N>::of_lanes { return plus(N(a), b); }
template <Number N> CORE_INLINE N operator+(N a, double b) requires IsNumber<N>::of_lanes { return plus(a, N(b)); }
template <Number N> CORE_INLINE N operator-(double a, N b) requires IsNumber<N>::of_lanes { return minus(N(a), b); }
template <Number N> CORE_INLINE N operator-(N a, double b) requires IsNumber<N>::of_lanes { return minus(a, N(b)); }

}  // namespace core
