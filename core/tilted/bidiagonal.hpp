// Singular values of a bidiagonal matrix (Golub and Van Loan, Matrix Computations, 8.6), with the rotations applied
// to rows of eight numbers on either side.
#pragma once

#include "../poles/rows.hpp"

namespace core {

// The diagonal, what is above it, and what goes along with columns (right) and rows (left) of the matrix.
struct Bidiagonal {
    std::vector<double> diagonal, above;
    Row right, left;  // (size, 8)

    explicit Bidiagonal(int size) : diagonal(size, 0.0), above(size, 0.0), right(8 * size_t(size)), left(8 * size_t(size)) {}
    int size() const { return int(diagonal.size()); }
};

namespace detail {

// cos and sin of the rotation that takes (x, y) to (r, 0).
struct Rotation {
    double cos = 1.0, sin = 0.0, r = 0.0;
    Rotation(double x, double y) : r(std::sqrt(x * x + y * y)) {
        if (r > 0) cos = x / r, sin = y / r;
    }
    void of_rows(double* rows) const {  // a row and the next one
        Columns first = Columns::load(rows), second = Columns::load(rows + 8);
        (first * cos + second * sin).store(rows), (second * cos - first * sin).store(rows + 8);
    }
};

// The eigenvalue of the last 2×2 block of BᵀB that is nearer to its last entry (Wilkinson's shift).
inline double shift_of(const Bidiagonal& B, int first, int last) {
    double d = B.diagonal[last - 1], e = B.above[last - 1], before = last - 1 > first ? B.above[last - 2] : 0.0;
    double upper = d * d + before * before, beside = d * e, lower = B.diagonal[last] * B.diagonal[last] + e * e;
    double half = (upper - lower) / 2, root = std::sqrt(half * half + beside * beside);
    return root > 0 ? lower - beside * beside / (half + std::copysign(root, half)) : lower;
}

// Chase the bulge of one step from `first` to `last`.
inline void sweep(Bidiagonal& B, int first, int last, double shift) {
    double x = B.diagonal[first] * B.diagonal[first] - shift, y = B.diagonal[first] * B.above[first];
    for (int k = first; k < last; ++k) {
        double &d = B.diagonal[k], &next = B.diagonal[k + 1], &e = B.above[k];
        Rotation columns(x, y);
        if (k > first) B.above[k - 1] = columns.r;
        x = d * columns.cos + e * columns.sin, e = e * columns.cos - d * columns.sin;
        y = next * columns.sin, next = next * columns.cos;
        columns.of_rows(&B.right[8 * k]);
        Rotation rows(x, y);
        d = rows.r;
        double above = e * rows.cos + next * rows.sin;
        next = next * rows.cos - e * rows.sin, e = above;
        rows.of_rows(&B.left[8 * k]);
        if (k + 1 < last) x = e, y = B.above[k + 1] * rows.sin, B.above[k + 1] *= rows.cos;
    }
}

}  // namespace detail

// Turn the diagonal into the singular values, some negative; return whether it has converged.
inline bool diagonalise(Bidiagonal& B) {
    constexpr double EPSILON = 2.3e-16;
    constexpr int SWEEPS = 60;  // most for one value
    double largest = 0.0;
    for (double d : B.diagonal) largest = std::max(largest, std::abs(d));
    for (double e : B.above) largest = std::max(largest, std::abs(e));
    for (double& d : B.diagonal)  // a zero would stop the chase, and so much is rounding
        if (std::abs(d) < EPSILON * largest) d = EPSILON * largest;
    int count = 0;
    for (int last = B.size() - 1; last > 0;) {
        for (int k = 0; k < last; ++k)
            if (!(std::abs(B.above[k]) > EPSILON * (std::abs(B.diagonal[k]) + std::abs(B.diagonal[k + 1])))) B.above[k] = 0.0;
        if (B.above[last - 1] == 0) {
            --last, count = 0;
            continue;
        }
        if (++count > SWEEPS) return false;
        int first = last - 1;
        while (first > 0 && B.above[first - 1] != 0) --first;
        detail::sweep(B, first, last, detail::shift_of(B, first, last));
    }
    return true;
}

}  // namespace core
