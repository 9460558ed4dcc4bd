// Householder's tridiagonalisation of one set, and implicit QL of LANES sets at once (Golub and Van
// Loan, Matrix Computations, 8.3), with the same orthogonal steps applied to the 8 rows that the ends
// see: eigenvectors are never needed.
//
// The steps of QL wait for each other's roots and divisions, so eight sets share them; where one set is
// done before the others its steps are multiplications by one.
#pragma once

#include "pencil.hpp"

namespace core {

constexpr int SETS = 8;  // sets whose levels are worked out together
using Sets = Lanes<SETS>;

// Diagonal, what is beside it, and the ends' rows, of up to SETS sets.
struct Tridiagonal {
    int n = 0;
    std::vector<Sets> diagonal, off;       // off[k] is between k and k + 1
    std::vector<std::array<Sets, 8>> rows;

    // Room for n; what no set fills are levels far away that the ends do not see.
    explicit Tridiagonal(int n) : n(n), diagonal(n, Sets(1.0)), off(n, Sets(0.0)), rows(n) {
        for (auto& row : rows) row.fill(Sets(0.0));
    }
};

// Tridiagonalise the pencil's A, destroyed, into lane `set` of T.
inline void tridiagonalise(Pencil& pencil, Tridiagonal& T, int set) {
    // Entry m here is entry k = r − 1 − m of the pencil, so that active rows start at column 0.
    static const std::array<double, 16> MASKS = {1, 1, 1, 1, 1, 1, 1, 1};  // then zeros
    int r = pencil.rank, n = pencil.n, width = padded(r);
    auto row_of = [&](int m) { return &pencil.A[size_t(r - 1 - m) * n]; };
    auto seen = [&](int m) { return &pencil.rows[8 * (r - 1 - m)]; };
    std::vector<double> v(width), p(width), next(width), product(width);
    for (int m = r - 1; m >= 0; --m) {
        double* row = row_of(m);
        for (int c = 0; c <= m; ++c) row[c] -= v[m] * p[c] + p[m] * v[c];
        int k = r - 1 - m;
        T.diagonal[k].set(set, row[m]);
        if (m == 0) break;
        double head = row[m - 1], tail = 0.0;
        for (int c = 0; c < m - 1; ++c) tail += row[c] * row[c];
        double norm = std::sqrt(tail + head * head);
        double alpha = !(tail > 0) ? head : head > 0 ? -norm : norm;
        double beta = tail > 0 ? 1.0 / (norm * (norm + std::abs(head))) : 0.0;
        T.off[k].set(set, alpha);
        for (int c = 0; c < width; ++c) next[c] = c < m - 1 ? row[c] : 0.0, product[c] = 0.0;
        next[m - 1] = head - alpha;
        for (int i = 0; i < m; ++i) {  // subtract v pᵀ + p vᵀ and multiply by `next`, in one pass
            double* a = row_of(i);
            double diagonal = a[i] - (v[i] * p[i] + p[i] * v[i]);
            Columns vi = v[i], pi = p[i], ni = next[i], total = 0.0;
            int c = 0;
            for (; c + COLUMNS <= i; c += COLUMNS) {
                Columns entry = Columns::load(a + c) - vi * Columns::load(&p[c]) - pi * Columns::load(&v[c]);
                entry.store(a + c);
                total = total + entry * Columns::load(&next[c]);
                (Columns::load(&product[c]) + entry * ni).store(&product[c]);
            }
            if (c < i) {
                Columns mask = Columns::load(MASKS.data() + 8 - (i - c));
                Columns entry = Columns::load(a + c) - vi * Columns::load(&p[c]) - pi * Columns::load(&v[c]);
                entry = mask * entry;
                entry.store(a + c);
                total = total + entry * Columns::load(&next[c]);
                (Columns::load(&product[c]) + entry * ni).store(&product[c]);
            }
            a[i] = diagonal;
            product[i] += sum(total) + diagonal * next[i];
        }
        double overlap = 0.0;
        for (int c = 0; c < m; ++c) product[c] *= beta, overlap += product[c] * next[c];
        overlap *= 0.5 * beta;
        Columns along = 0.0;
        for (int c = 0; c < m; ++c) {
            v[c] = next[c];
            p[c] = product[c] - overlap * next[c];
            along = along + next[c] * Columns::load(seen(c));
        }
        v[m] = p[m] = 0.0;
        along = beta * along;
        for (int c = 0; c < m; ++c) (Columns::load(seen(c)) - next[c] * along).store(seen(c));
    }
    for (int k = 0; k < r; ++k)
        for (int c = 0; c < 8; ++c) T.rows[k][c].set(set, pencil.rows[8 * k + c]);
}

namespace detail {

// Chase each set's bulge from its end to `first`, carrying the row that turns next along.
inline void sweep(Tridiagonal& T, int first, int last, Sets end, Sets g) {
    const Sets zero = 0.0, one = 1.0;
    Sets s = one, c = one, p = zero;
    std::array<Sets, 8> carried = T.rows[last];
    for (int i = last - 1; i >= first; --i) {
        Sets here = double(i), below = T.diagonal[i + 1], f = s * T.off[i], b = c * T.off[i];
        Sets square = f * f + g * g, r = root(square);
        Sets over = where_greater(square, zero, inverse(r), zero);
        Sets sine = f * over, cosine = g * over;
        cosine = where_greater(square, zero, cosine, one);
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
