// Matrices between directions of which many depend on the others, reduced to one small matrix.
//
// N = ⟨j|k⟩ and K = ⟨j|A|k⟩, A symmetric or antisymmetric.  Directions that depend on the others are left out by
// Cholesky's factorisation N = LLᵀ with pivots; only the rows that are chosen are ever worked out.  Then A = L⁻¹KL⁻ᵀ,
// and what the ends see of the directions becomes L⁻¹b.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rows.hpp"

namespace core {

// Directions of which less than this (squared, relative) is new are left out of the model.
constexpr double DROP = 1e-11;

enum Symmetry { SYMMETRIC = 1, ANTISYMMETRIC = -1 };  // Aᵀ = ±A

template <Symmetry SIGN>
struct Reduction {
    static constexpr double TURNED = SIGN;  // an entry's mirror image as a part of it
    int rank = 0, width = 0;
    Row A;     // (rank, width): row k holds columns rank − 1 down to 0 of the matrix
    Row rows;  // (rank, 8), what the ends see

protected:
    // Reduce n directions of norm 1 (a multiple of COLUMNS), without those of which less than `drop` (squared) is new:
    // of.row(d, N, K) writes the rows of direction d, of.seen(d, b) what the ends see of it.
    template <class Directions>
    void reduce(int n, const Directions& of, double drop = DROP) {
        rows.assign(n * 8, 0.0);
        for (auto* matrix : {&R, &L, &K, &Y, &A}) matrix->resize(size_t(n) * n);
        choose(n, of, drop);
        // an antisymmetric matrix of odd size has a level at zero that the wire has not
        if (SIGN == ANTISYMMETRIC && rank % 2 == 1) --rank;
        transform(n);
    }

private:
    Row R, L, K, Y;

    // The place of the largest entry, the first of equal ones, or −1 where none is above `drop`.
    static int largest(const Row& of, double drop) {
        Columns best = drop, at = -1.0;
        for (int j = 0; j < int(of.size()); j += COLUMNS) {
            Columns entry = Columns::load(&of[j]);
            at = where_greater(entry, best, Columns(j), at);
            best = larger(best, entry);
        }
        int found = -1;
        double most = drop;
        for (int l = 0; l < COLUMNS; ++l) {
            int here = int(at[l]) + l;
            if (at[l] >= 0.0 && (best[l] > most || (best[l] == most && here < found))) most = best[l], found = here;
        }
        return found;
    }

    template <class Directions>
    void choose(int n, const Directions& of, double drop) {
        Row pivots(n, 1.0), energy(n);
        std::vector<int> order;
        rank = 0;
        for (int k = 0; k < n; ++k) {
            int d = largest(pivots, drop);
            if (d < 0) break;
            double* row = &R[size_t(k) * n];
            double *l = &L[size_t(k) * n], *of_K = &K[size_t(k) * n];
            of.row(d, row, energy.data());
            order.push_back(d);
            for (int i = 0; i < k; ++i) l[i] = R[size_t(i) * n + d];
            for (int i = 0; i <= k; ++i) of_K[i] = energy[order[i]];
            of.seen(d, &rows[8 * k]);
            subtract_rows(row, R.data(), n, l, k, n);
            l[k] = std::sqrt(row[d]);
            scale_row(row, 1.0 / l[k], n);
            for (int j = 0; j < n; j += COLUMNS) {
                Columns entry = Columns::load(row + j), left = Columns::load(&pivots[j]) - entry * entry;
                left.store(&pivots[j]);
            }
            pivots[d] = -1.0;
            rank = k + 1;
        }
    }

    void transform(int n) {
        int r = rank;
        width = padded(r);
        for (int k = 0; k < r; ++k) {
            double* y = &Y[size_t(k) * width];
            for (int j = 0; j < r; ++j) y[j] = j <= k ? K[size_t(k) * n + j] : TURNED * K[size_t(j) * n + k];
            for (int j = r; j < width; ++j) y[j] = 0.0;
        }
        substitute(L.data(), n, r, Y.data(), width, [&](int) { return width; });
        substitute(L.data(), n, r, rows.data(), 8, [](int) { return 8; });
        auto part = [&](int first) { return padded(r - first); };
        for (int k = 0; k < r; ++k) {
            double* a = &A[size_t(k) * width];
            for (int c = 0; c < part(k - k % TOGETHER); ++c) a[c] = c < r ? TURNED * Y[size_t(r - 1 - c) * width + k] : 0.0;
        }
        substitute(L.data(), n, r, A.data(), width, part);
        for (int k = 0; k < r; ++k) {  // the other triangle
            for (int c = 0; c < r - 1 - k; ++c) A[size_t(r - 1 - c) * width + r - 1 - k] = TURNED * A[size_t(k) * width + c];
            if (SIGN == ANTISYMMETRIC) A[size_t(k) * width + r - 1 - k] = 0.0;
        }
    }
};

}  // namespace core
