// The path in the plane of energies on which the thermal average of a derivative is summed.
//
// Where the window ends below the gap, it is a line above the real axis,
//
//     ∫ f dω = h Σ_j f(x_j + ia) + Σ_k 2πi Res_k f / (1 + exp(−2πi(z_k* − ia)/h)),   x_j = (j + ½)h,
//
// where the last factor is one for poles far below the line and zero for those far above it, and in between takes
// away what a pole near the line puts into the sum.  What is left is of the order of exp(−2πa/h) from the poles of G
// and exp(−2π(πkT − a)/h) from those of K.
//
// Where it does not, f is another function above the gap.  So the line comes down to the real axis next to the gap, at ±E, behind
// the last levels that are told apart, and the path goes on along the axis, where f is smooth in τ: below the gap
// ω = Δ₀ tanh τ, above it ω = Δ₀ cosh τ.  On the line and where it comes down points z_j have the weights w_j of Gauss and Legendre,
//
//     ∫_{−E}^{E} f dω = Σ_j w_j f(z_j) + Σ_k Res_k f · (log (E − z_k*)/(−E − z_k*) − Σ_j w_j/(z_j − z_k*)),
//
// which is exact for a pole wherever it is.  Coming down, points gather as levels do, at E + iη sinh u with η = Δ₀ − E.
#pragma once

#include <numbers>

#include "../thermal/plan.hpp"

namespace core {

constexpr double HEIGHT = std::numbers::pi / 2;  // of the line, in kT: half way to the poles of the kernel
// Of the line, in kT.
struct Line {
    double step, further;  // and how far it goes beyond the plan's window
};
// Of 320 random derivatives half are within 2e-5 of the largest; with steps of 0.75, 0.65 and 0.55 they are within 4e-5, 7e-6 and
// 3e-6.  Where the line ends with the window, 64 to 74 of a hundred are within 1e-4, with this end 73 to 88, with 4 kT more 79 to 91.
constexpr Line EXACT{0.7, 1.9};
// With the model's poles, of 108 sets of four wires half are within 0.3 % of the largest derivative by V, and 95 % within 2 %.  With
// steps of 1.0 and 1.2 these are 0.2 and 1.5 %, and 0.5 and 3 %; where the line ends 5 kT before the window, 0.4 and 4 %.
constexpr Line ROUGH{1.1, -4.0};
constexpr double BEYOND = 3.0;  // poles up to so many steps above the line are seen by it
// Of a path to the gap: to what power of 1/e the line is right, and points where it comes down, next to the gap and above it.  Of 200
// derivatives of hot wires each by V, μ, γ and Δ₀ 97, 93, 94 and 90 % are within 1e-4 of the largest.  With a power of 12 it is 94,
// 89, 89 and 89 %, with 17 no more than here; with 24 points next to the gap 94 % by μ, in 1.2 times the time.
constexpr double POWER = 15.0;
constexpr int COMING_DOWN = 20, NEXT_TO_GAP = 12;
constexpr double ABOVE_GAP = 8.0;  // for each unit of τ

class Path {
public:
    struct Point {
        Amplitude z, weight;
    };
    double height, step;
    double end;                                        // poles of Re z beyond it do not count
    std::vector<Point> above_axis, next_to_gap, above_gap;  // Re z ≥ 0; −z̄ counts, too

    // Of a window, in meV, that ends below the gap; so does the line.
    Path(double window, double kT, double delta0, const Line& line = EXACT) : Path(kT, line.step) {
        end = std::min(window + line.further * kT, BELOW_GAP * delta0);
        for (int j = 0; j < int(std::ceil(end / step)); ++j) above_axis.push_back({{(j + 0.5) * step, height}, step});
    }
    // Of one that does not; levels are told apart up to the given τ.
    Path(double window, double kT, double delta0, double tau) : Path(kT, EXACT.step) {
        end = delta0, edge = delta0 * std::tanh(tau);
        const GaussLegendre line(2 * int(std::ceil(POWER / (4 * std::asinh(height / edge))))), down(COMING_DOWN), next(NEXT_TO_GAP);
        for (size_t k = line.node.size() / 2; k < line.node.size(); ++k)
            above_axis.push_back({{edge * line.node[k], height}, edge * line.weight[k]});
        const double unit = delta0 - edge, most = std::asinh(height / unit);
        for (int k = 0; k < COMING_DOWN; ++k) {
            double u = most * (1 + down.node[k]) / 2, weight = most * down.weight[k] / 2;
            above_axis.push_back({{edge, unit * std::sinh(u)}, {0, -unit * std::cosh(u) * weight}});
        }
        const double last = std::exp(-2 * tau);
        for (int k = 0; k < NEXT_TO_GAP; ++k) {
            double at = last * (1 + next.node[k]) / 2;  // exp(−2τ)
            next_to_gap.push_back({delta0 * (1 - at) / (1 + at), delta0 * last * next.weight[k] / ((1 + at) * (1 + at))});
        }
        const double farthest = std::acosh(std::max((window + EXACT.further * kT) / delta0, LEAST_ABOVE));
        const GaussLegendre over(int(std::ceil(ABOVE_GAP * farthest)));
        for (size_t k = 0; k < over.node.size(); ++k) {
            double at = farthest * (1 + over.node[k]) / 2;
            above_gap.push_back({delta0 * std::cosh(at), delta0 * std::sinh(at) * over.weight[k] * farthest / 2});
        }
    }

    bool reaches_gap() const { return std::isfinite(edge); }
    bool sees(Amplitude z) const { return z.imag() < height + BEYOND * step && z.real() < end; }
    Amplitude weight_of_pole(Amplitude z) const {
        if (!reaches_gap()) {
            const Amplitude turn(0, 2 * std::numbers::pi);
            return turn / (1.0 + std::exp(-turn * (z - Amplitude(0, height)) / step));
        }
        Amplitude weight = std::log(edge - z) - std::log(-edge - z);
        for (const Point& of : above_axis) weight -= of.weight / (of.z - z) + std::conj(of.weight) / (-std::conj(of.z) - z);
        return weight;
    }

private:
    double edge = INFINITY;

    Path(double kT, double step) : height(HEIGHT * kT), step(step * kT) {}
};

}  // namespace core
