// The Loewner pencil of one set, and its reduction to one symmetric matrix.
//
// See levels.hpp for the mathematics: N = ⟨j|k⟩ and K = ⟨j|A|k⟩ between the 8M directions of M nodes.
// Directions that depend on the others are left out by Cholesky's factorisation N = LLᵀ with pivots;
// only the rows that are chosen are ever worked out.  Then A = L⁻¹KL⁻ᵀ, and what the ends see of the
// directions becomes L⁻¹b.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rows.hpp"

namespace core {

// Directions of which less than this (squared, relative) is new are left out of the model.
constexpr double DROP = 1e-11;

// G and dG/dω of the isolated wire's ends at a node, chiral basis, 1/meV and 1/meV².
struct NodeData {
    double G[8][8], slope[8][8];
};

struct Pencil {
    int n = 0, rank = 0, width = 0;
    Row A;     // (rank, width): row k holds columns rank − 1 down to 0 of the matrix
    Row rows;  // (rank, 8), what the ends see

    // omega: the nodes in meV.
    void make(const double* omega, const NodeData* data, int nodes) {
        n = 8 * nodes;
        phi.resize(n * 8), norm.resize(n * 8), scale.resize(n);
        rows.assign(n * 8, 0.0);
        for (auto* matrix : {&R, &L, &K, &Y, &A}) matrix->resize(size_t(n) * n);
        apart.resize(size_t(nodes) * nodes);
        for (int k = 0; k < nodes; ++k)
            for (int m = 0; m < nodes; ++m)
                apart[k * nodes + m] = k == m ? 0.0 : 1.0 / ((omega[k] - omega[m]) * (omega[k] + omega[m]));
        for (int k = 0; k < nodes; ++k) resolvents(omega[k], data[k], phi.data() + 64 * k, norm.data() + 64 * k);
        for (int i = 0; i < n; ++i) scale[i] = 1.0 / std::sqrt(norm[8 * i + i % 8]);
        choose(omega, nodes);
        reduce();
    }

private:
    Row phi, norm, scale, apart, R, L, K, Y;  // apart: 1/(x_k − x_m)

    // Φ − diag(0, 1) and −dΦ/dx.
    static void resolvents(double w, const NodeData& at, double* phi, double* norm) {
        double over = 1.0 / w, half = -0.5 / w;
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) {
                double G = at.G[i][j], slope = at.slope[i][j], &value = phi[8 * i + j], &minus = norm[8 * i + j];
                if (i < 4 && j < 4) {
                    value = G * over;
                    minus = (slope - value) * over * half;
                } else if (i >= 4 && j >= 4) {
                    minus = (slope * w + G) * half;
                    value = G * w - (i == j ? 1.0 : 0.0);
                } else {
                    value = G;
                    minus = slope * half;
                }
            }
    }

    // N and K between direction d and all others.
    void pencil_row(const double* omega, int nodes, int d, double* of_N, double* of_K) const {
        int own_node = d / 8, i = d % 8;
        double x = omega[own_node] * omega[own_node];
        Columns own = Columns::load(&phi[8 * d]);
        for (int k = 0; k < nodes; ++k) {
            Columns other = Columns::load(&phi[64 * k + 8 * i]);
            Columns product = apart[k * nodes + own_node] * (own - other);
            if (k == own_node) product = Columns::load(&norm[8 * d]);
            Columns factor = scale[d] * Columns::load(&scale[8 * k]);
            Columns overlap = product * factor, energy = (x * product - other) * factor;
            overlap.store(of_N + 8 * k), energy.store(of_K + 8 * k);
        }
    }

    // The place of the largest entry, the first of equal ones, or −1 where none is above DROP.
    static int largest(const Row& of) {
        Columns best = DROP, at = -1.0;
        for (int j = 0; j < int(of.size()); j += COLUMNS) {
            Columns entry = Columns::load(&of[j]);
            at = where_greater(entry, best, Columns(j), at);
            best = larger(best, entry);
        }
        int found = -1;
        double most = DROP;
        for (int l = 0; l < COLUMNS; ++l) {
            int here = int(at[l]) + l;
            if (at[l] >= 0.0 && (best[l] > most || (best[l] == most && here < found))) most = best[l], found = here;
        }
        return found;
    }

    void choose(const double* omega, int nodes) {
        Row pivots(n, 1.0), energy(n);
        std::vector<int> order;
        rank = 0;
        for (int k = 0; k < n; ++k) {
            int d = largest(pivots);
            if (d < 0) break;
            double* row = &R[size_t(k) * n];
            double *l = &L[size_t(k) * n], *of_K = &K[size_t(k) * n];
            pencil_row(omega, nodes, d, row, energy.data());
            order.push_back(d);
            for (int i = 0; i < k; ++i) l[i] = R[size_t(i) * n + d];
            for (int i = 0; i <= k; ++i) of_K[i] = energy[order[i]];
            for (int c = 0; c < 8; ++c) rows[8 * k + c] = scale[d] * phi[8 * d + c];
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

    void reduce() {
        int r = rank;
        width = padded(r);
        for (int k = 0; k < r; ++k) {
            double *y = &Y[size_t(k) * width], *l = &L[size_t(k) * n];
            for (int j = 0; j < r; ++j) y[j] = j <= k ? K[size_t(k) * n + j] : K[size_t(j) * n + k];
            for (int j = r; j < width; ++j) y[j] = 0.0;
            subtract_rows(y, Y.data(), width, l, k, width);
            subtract_rows(&rows[8 * k], rows.data(), 8, l, k, 8);
            scale_row(y, 1.0 / l[k], width);
            scale_row(&rows[8 * k], 1.0 / l[k], 8);
        }
        for (int k = 0; k < r; ++k) {
            double *a = &A[size_t(k) * width], *l = &L[size_t(k) * n];
            int part = padded(r - k);
            for (int c = 0; c < part; ++c) a[c] = c < r ? Y[size_t(r - 1 - c) * width + k] : 0.0;
            subtract_rows(a, A.data(), width, l, k, part);
            scale_row(a, 1.0 / l[k], part);
        }
        for (int k = 0; k < r; ++k)  // the other triangle
            for (int c = 0; c < r - 1 - k; ++c) A[size_t(r - 1 - c) * width + r - 1 - k] = A[size_t(k) * width + c];
    }
};

}  // namespace core
