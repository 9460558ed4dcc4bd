// The Loewner pencil of one set.
//
// See levels.hpp for the mathematics: N = ⟨j|k⟩ and K = ⟨j|A|k⟩ between the 8M directions of M nodes.
#pragma once

#include "reduction.hpp"

namespace core {

// G and dG/dω of the isolated wire's ends at a node, chiral basis, 1/meV and 1/meV².
struct NodeData {
    double G[8][8], slope[8][8];
};

class Pencil : public Reduction<SYMMETRIC> {
    Row phi, norm, scale, apart;  // apart: 1/(x_k − x_m)
    const double* omega = nullptr;
    int nodes = 0;

public:
    // at: the nodes in meV.
    void make(const double* at, const NodeData* data, int count) {
        omega = at, nodes = count;
        int n = 8 * nodes;
        phi.resize(n * 8), norm.resize(n * 8), scale.resize(n);
        apart.resize(size_t(nodes) * nodes);
        for (int k = 0; k < nodes; ++k)
            for (int m = 0; m < nodes; ++m)
                apart[k * nodes + m] = k == m ? 0.0 : 1.0 / ((omega[k] - omega[m]) * (omega[k] + omega[m]));
        for (int k = 0; k < nodes; ++k) resolvents(omega[k], data[k], phi.data() + 64 * k, norm.data() + 64 * k);
        for (int i = 0; i < n; ++i) scale[i] = 1.0 / std::sqrt(norm[8 * i + i % 8]);
        reduce(n, *this);
    }

    // N and K between direction d and all others.
    void row(int d, double* of_N, double* of_K) const {
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

    // What the ends see of direction d.
    void seen(int d, double* of_ends) const {
        for (int c = 0; c < 8; ++c) of_ends[c] = scale[d] * phi[8 * d + c];
    }

private:
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
};

}  // namespace core
