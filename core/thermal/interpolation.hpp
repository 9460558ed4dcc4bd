// The polynomial through a function's values at some nodes, by the barycentric formula (Berrut and Trefethen 2004).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace core {

// Gauss–Legendre nodes and weights on [−1, 1], by Newton's iteration on P_n.
struct GaussLegendre {
    std::vector<double> node, weight;

    explicit GaussLegendre(int n) : node(n), weight(n) {
        for (int i = 0; i < n; ++i) {
            double z = -std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1.0;
            for (int step = 0; step < 100; ++step) {
                double before = 1.0, now = z;
                for (int k = 2; k <= n; ++k) {
                    double next = ((2 * k - 1) * z * now - (k - 1) * before) / k;
                    before = now, now = next;
                }
                slope = n * (z * now - before) / (z * z - 1);
                double change = now / slope;
                z -= change;
                if (std::abs(change) < 1e-15) break;
            }
            node[i] = z;
            weight[i] = 2 / ((1 - z * z) * slope * slope);
        }
    }
};

// Nodes in [−1, 1] and their barycentric weights.
struct Interpolation {
    std::vector<double> node, weight;

    int size() const { return int(node.size()); }

    // Add to the weights of the values at the nodes those of the polynomial at u, times `share`.
    void add(double u, double share, double* to) const {
        double total = 0.0;
        for (int k = 0; k < size(); ++k) {
            if (u == node[k]) {
                to[k] += share;
                return;
            }
            total += weight[k] / (u - node[k]);
        }
        for (int k = 0; k < size(); ++k) to[k] += share * (weight[k] / (u - node[k])) / total;
    }
};

// Chebyshev's nodes, u_k = sin(π(k + ½)/2M), then −u_k.
inline Interpolation chebyshev_nodes(int M) {
    Interpolation of;
    for (int sign : {1, -1})
        for (int k = 0; k < M; ++k) {
            double angle = std::numbers::pi * (k + 0.5) / (2 * M);
            of.node.push_back(sign * std::sin(angle));
            of.weight.push_back((k % 2 == 0) == (sign > 0) ? std::cos(angle) : -std::cos(angle));
        }
    return of;
}

// The polynomials through the nearest of some nodes and of their mirror images; from the first sample on, straight lines:
// what is rough there stays there.
class LocalInterpolation {
    static constexpr int NEAREST = 4;  // most nodes on either side
    std::vector<double> node;          // in order, those above zero; then where their values stand
    std::vector<int> value;
    int smooth = 0;                    // nodes before the first sample

public:
    LocalInterpolation() = default;
    LocalInterpolation(const std::vector<double>& nodes, const std::vector<double>& samples) {
        for (int k = 0; k < int(nodes.size()); ++k)
            if (samples.empty() || nodes[k] < samples.front()) node.push_back(nodes[k]), value.push_back(k);
        smooth = int(node.size());
        for (int k = 0; k < int(samples.size()); ++k) node.push_back(samples[k]), value.push_back(int(nodes.size()) + k);
    }

    // As Interpolation::add, of values at all nodes and samples, then at their mirror images; beyond the last one its value is
    // taken.
    void add(double u, double share, double* to, int mirrored) const {
        bool minus = u < 0;
        u = std::min(std::abs(u), node.back());
        int below = std::min(int(std::upper_bound(node.begin(), node.end(), u) - node.begin()), int(node.size()) - 1) - 1;
        int side = std::clamp(std::min(smooth, int(node.size()) - 1) - below, 1, NEAREST);
        // The nodes of the mirror image are −1, −2, …
        auto at = [&](int k) { return k >= 0 ? node[k] : -node[-1 - k]; };
        for (int k = below + 1 - side; k <= below + side; ++k) {
            double part = share;
            for (int other = below + 1 - side; other <= below + side; ++other)
                if (other != k) part *= (u - at(other)) / (at(k) - at(other));
            to[value[k >= 0 ? k : -1 - k] + ((k < 0) != minus ? mirrored : 0)] += part;
        }
    }
};

// M of Legendre's nodes on [0, 1].
inline Interpolation legendre_nodes(int M) {
    const GaussLegendre rule(M);
    Interpolation of;
    for (int k = 0; k < M; ++k) {
        double u = rule.node[k], root = std::sqrt((1 - u * u) * rule.weight[k]);
        of.node.push_back((1 + u) / 2);
        of.weight.push_back(k % 2 == 0 ? root : -root);
    }
    return of;
}

}  // namespace core
