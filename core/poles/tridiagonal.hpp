// Householder's tridiagonalisation of one set, and implicit QL of LANES sets at once (Golub and Van
// Loan, Matrix Computations, 8.3), with the same orthogonal steps applied to the 8 rows that the ends
// see: eigenvectors are never needed.
//
// The steps of QL wait for each other's roots and divisions, so eight sets share them; where one set is
// done before the others its steps are multiplications by one.
#pragma once

#include "reduction.hpp"

namespace core {

constexpr int SETS = 8;  // sets whose levels are worked out together
using Sets = Lanes<SETS>;

// Diagonal, what is beside it, and the ends' rows, of up to SETS sets.
struct Tridiagonal {
    int n = 0;
    std::vector<Sets> diagonal, off;       // off[k] is between k and k + 1
    std::vector<std::array<Sets, 8>> rows;

    // Room for n; what no set fills are levels far away that the ends do not see.
    void clear(int size) {
        n = size;
        diagonal.assign(n, Sets(1.0)), off.assign(n, Sets(0.0)), rows.resize(n);
        for (auto& row : rows) row.fill(Sets(0.0));
    }
};

namespace detail {

// x − v p ∓ p' v'.
template <Symmetry SIGN>
CORE_INLINE Columns without(Columns x, Columns v, Columns p, Columns other_p, Columns other_v) {
    if constexpr (SIGN == SYMMETRIC) return x - v * p - other_p * other_v;
    else return x - v * p + other_p * other_v;
}

// Subtract v pᵀ ± p vᵀ from the first m rows of A = ±Aᵀ and multiply these by `next`, in one pass.
template <Symmetry SIGN, int BLOCKS>
CORE_INLINE void update_and_multiply(double* A, std::ptrdiff_t stride, int m, int first, const double* v, const double* p,
                                     const double* next, double* product) {
    Columns vc[BLOCKS], pc[BLOCKS], total[BLOCKS];
    for (int b = 0; b < BLOCKS; ++b) {
        vc[b] = Columns::load(v + first + b * COLUMNS), pc[b] = Columns::load(p + first + b * COLUMNS);
        total[b] = 0.0;
    }
    for (int i = 0; i < m; ++i) {
        double* row = A + i * stride + first;
        Columns vi = v[i], pi = p[i], ni = next[i];
        for (int b = 0; b < BLOCKS; ++b) {
            Columns entry = without<SIGN>(Columns::load(row + b * COLUMNS), vi, pc[b], pi, vc[b]);
            entry.store(row + b * COLUMNS);
            total[b] = total[b] + entry * ni;
        }
    }
    for (int b = 0; b < BLOCKS; ++b) total[b].store(product + first + b * COLUMNS);
}

}  // namespace detail

// Tridiagonalise A, destroyed, and turn the rows along: diagonal(k, value) and off(k, value), of row k and column k + 1, take
// the result.
template <Symmetry SIGN, class Diagonal, class Off>
inline void tridiagonalise(Reduction<SIGN>& pencil, Diagonal diagonal, Off off) {
    // Entry m here is entry k = r − 1 − m of the pencil, so that active rows and columns start at 0.
    int r = pencil.rank, width = pencil.width;
    double* A = &pencil.A[size_t(r - 1) * width];
    auto seen = [&](int m) { return &pencil.rows[8 * (r - 1 - m)]; };
    Row v(width), p(width), next(width), product(width);
    for (int m = r - 1; m >= 0; --m) {
        int k = r - 1 - m, active = padded(m);
        double* row = A - std::ptrdiff_t(m) * width;
        for (int j = 0; j < padded(m + 1); j += COLUMNS) {
            Columns entry = detail::without<SIGN>(Columns::load(row + j), v[m], Columns::load(&p[j]), p[m], Columns::load(&v[j]));
            entry.store(row + j);
        }
        diagonal(k, row[m]);
        if (m == 0) break;
        double head = row[m - 1];
        for (int c = 0; c < width; ++c) next[c] = c < m - 1 ? row[c] : 0.0;
        double tail = dot(next.data(), next.data(), active), norm = std::sqrt(tail + head * head);
        double alpha = !(tail > 0) ? head : head > 0 ? -norm : norm;
        double beta = tail > 0 ? 1.0 / (norm * (norm + std::abs(head))) : 0.0;
        off(k, alpha);
        next[m - 1] = head - alpha;
        int j = 0;
        for (; j + 2 * COLUMNS <= active; j += 2 * COLUMNS)
            detail::update_and_multiply<SIGN, 2>(A, -std::ptrdiff_t(width), m, j, v.data(), p.data(), next.data(), product.data());
        if (j < active) detail::update_and_multiply<SIGN, 1>(A, -std::ptrdiff_t(width), m, j, v.data(), p.data(), next.data(), product.data());
        for (int c = m; c < active; ++c) product[c] = 0.0;
        double overlap = SIGN == SYMMETRIC ? 0.5 * beta * beta * dot(product.data(), next.data(), active) : 0.0;
        Columns even = 0.0, odd = 0.0;
        for (int c = 0; c < m; ++c) {
            v[c] = next[c];
            p[c] = beta * product[c] - overlap * next[c];
            (c % 2 == 0 ? even : odd) += next[c] * Columns::load(seen(c));
        }
        v[m] = p[m] = 0.0;
        Columns along = beta * (even + odd);
        for (int c = 0; c < m; ++c) (Columns::load(seen(c)) - next[c] * along).store(seen(c));
    }
}

// The same of a symmetric A, into lane `set` of T.
inline void tridiagonalise(Reduction<SYMMETRIC>& pencil, Tridiagonal& T, int set) {
    tridiagonalise(pencil, [&](int k, double value) { T.diagonal[k].set(set, value); }, [&](int k, double value) { T.off[k].set(set, value); });
    for (int k = 0; k < pencil.rank; ++k)
        for (int c = 0; c < 8; ++c) T.rows[k][c].set(set, pencil.rows[8 * k + c]);
}

namespace detail {

// Chase each set's bulge from its end to `first`, carrying the row that turns next along.
inline void sweep(Tridiagonal& T, int first, int last, Sets end, Sets g) {
    const Sets zero = 0.0, one = 1.0, tiny = 1e-290;
    Sets s = one, c = one, p = zero;
    std::array<Sets, 8> carried = T.rows[last];
    for (int i = last - 1; i >= first; --i) {
        Sets here = double(i), below = T.diagonal[i + 1], f = s * T.off[i], b = c * T.off[i];
        Sets square = f * f + g * g, r = root(square);
        Sets over = where_greater(square, tiny, Sets(r * inverse(square)), zero);  // 1/r, with the division beside the root
        Sets sine = f * over, cosine = g * over;
        cosine = where_greater(square, tiny, cosine, one);
        Sets h = below - p, x = (T.diagonal[i] - h) * sine + (b + b) * cosine, q = sine * x;
        T.off[i + 1] = where_greater(end, here, r, T.off[i + 1]);
        T.diagonal[i + 1] = where_greater(end, here, h + q, below);
        Sets new_g = cosine * x - b;
        g = where_greater(end, here, new_g, g);
        p = where_greater(end, here, q, p);
        s = where_greater(end, here, sine, s), c = where_greater(end, here, cosine, c);
        sine = where_greater(end, here, sine, zero), cosine = where_greater(end, here, c, one);
        for (int k = 0; k < 8; ++k) {
            Sets q_k = T.rows[i][k];
            T.rows[i + 1][k] = sine * q_k + cosine * carried[k];
            carried[k] = cosine * q_k - sine * carried[k];
        }
    }
    T.rows[first] = carried;
    T.diagonal[first] = T.diagonal[first] - p;  // p = 0 where nothing was to do
    T.off[first] = where_greater(end, Sets(double(first)), g, T.off[first]);
}

}  // namespace detail

// Turn the diagonal into the eigenvalues and row k into the 8-vector of eigenvector k; return whether it
// has converged.  NaN stays with its set.
inline bool diagonalise(Tridiagonal& T) {
    constexpr double EPSILON = 2.3e-16;
    constexpr int SWEEPS = 60;  // most for one level
    int n = T.n;
    T.off[n - 1] = 0.0;
    for (int first = 0; first < n; ++first)
        for (int count = 0;; ++count) {
            Sets end = double(n - 1);  // where each set's matrix first falls apart
            for (int k = n - 2; k >= first; --k) {
                Sets around = size(T.diagonal[k]) + size(T.diagonal[k + 1]), tiny = EPSILON * around;
                end = where_greater(size(T.off[k]), tiny, end, Sets(double(k)));
            }
            int last = first;
            for (int l = 0; l < SETS; ++l) last = std::max(last, int(end[l]));
            if (last == first) break;
            if (count == SWEEPS) return false;
            Sets shifted = 0.0;
            for (int l = 0; l < SETS; ++l) {
                int m = int(end[l]);
                if (m <= first) continue;
                double d = T.diagonal[first][l], off = T.off[first][l];
                double h = (T.diagonal[first + 1][l] - d) / (2 * off), r = std::sqrt(h * h + 1);
                shifted.set(l, off / (h + std::copysign(r, h)) + T.diagonal[m][l] - d);
            }
            detail::sweep(T, first, last, end, shifted);
            for (int l = 0; l < SETS; ++l)
                if (int(end[l]) > first) T.off[int(end[l])].set(l, 0.0);
        }
    return true;
}

}  // namespace core
