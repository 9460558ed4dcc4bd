// Rows of matrices, eight columns at a time.  Sums over columns go in one order on every processor.
#pragma once

#include <algorithm>
#include <new>
#include <vector>

#include "../values/lanes.hpp"

namespace core {

constexpr int COLUMNS = 8;
using Columns = Lanes<COLUMNS>;

// Numbers that start at a multiple of COLUMNS, so that no load of them meets two lines of the cache.
template <class T>
struct AtColumns {
    using value_type = T;
    static constexpr std::align_val_t PLACE{sizeof(Columns)};
    AtColumns() = default;
    template <class Other> AtColumns(const AtColumns<Other>&) {}
    T* allocate(size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), PLACE)); }
    void deallocate(T* p, size_t) { ::operator delete(p, PLACE); }
    bool operator==(const AtColumns&) const { return true; }
};
using Row = std::vector<double, AtColumns<double>>;

inline int padded(int n) { return (n + COLUMNS - 1) / COLUMNS * COLUMNS; }

CORE_INLINE double sum(Columns x) {
    double part[COLUMNS];
    x.store(part);
    return ((part[0] + part[4]) + (part[2] + part[6])) + ((part[1] + part[5]) + (part[3] + part[7]));
}

inline double dot(const double* a, const double* b, int width) {
    Columns total = 0.0;
    for (int j = 0; j < width; j += COLUMNS) total = total + Columns::load(a + j) * Columns::load(b + j);
    return sum(total);
}

template <int BLOCKS>
CORE_INLINE void subtract_rows_from(double* target, const double* rows, int stride, const double* factors, int count) {
    Columns total[BLOCKS];
    for (int b = 0; b < BLOCKS; ++b) total[b] = Columns::load(target + b * COLUMNS);
    for (int i = 0; i < count; ++i) {
        const double* row = rows + size_t(i) * stride;
        Columns f = factors[i];
        for (int b = 0; b < BLOCKS; ++b) total[b] = total[b] - f * Columns::load(row + b * COLUMNS);
    }
    for (int b = 0; b < BLOCKS; ++b) total[b].store(target + b * COLUMNS);
}

// target −= Σ_i factors[i] · row i, i < count, over `width` columns (a multiple of COLUMNS).  Several blocks of
// columns go together, as each alone would wait for its own sum.
inline void subtract_rows(double* target, const double* rows, int stride, const double* factors, int count, int width) {
    int j = 0;
    for (; j + 4 * COLUMNS <= width; j += 4 * COLUMNS) subtract_rows_from<4>(target + j, rows + j, stride, factors, count);
    switch ((width - j) / COLUMNS) {
        case 3: return subtract_rows_from<3>(target + j, rows + j, stride, factors, count);
        case 2: return subtract_rows_from<2>(target + j, rows + j, stride, factors, count);
        case 1: return subtract_rows_from<1>(target + j, rows + j, stride, factors, count);
    }
}

// The same for TOGETHER targets at distances of `width`, with factors at distances of `apart`: rows are loaded once for all.
constexpr int TOGETHER = 4;
template <int BLOCKS>
CORE_INLINE void subtract_rows_from_all(double* targets, const double* rows, int width, const double* factors, int apart, int count) {
    Columns total[TOGETHER][BLOCKS];
    for (int t = 0; t < TOGETHER; ++t)
        for (int b = 0; b < BLOCKS; ++b) total[t][b] = Columns::load(targets + size_t(t) * width + b * COLUMNS);
    for (int i = 0; i < count; ++i) {
        Columns row[BLOCKS];
        for (int b = 0; b < BLOCKS; ++b) row[b] = Columns::load(rows + size_t(i) * width + b * COLUMNS);
        for (int t = 0; t < TOGETHER; ++t) {
            Columns f = factors[size_t(t) * apart + i];
            for (int b = 0; b < BLOCKS; ++b) total[t][b] = total[t][b] - f * row[b];
        }
    }
    for (int t = 0; t < TOGETHER; ++t)
        for (int b = 0; b < BLOCKS; ++b) total[t][b].store(targets + size_t(t) * width + b * COLUMNS);
}

inline void scale_row(double* row, double factor, int width) {
    for (int j = 0; j < width; j += COLUMNS) {
        Columns scaled = factor * Columns::load(row + j);
        scaled.store(row + j);
    }
}

// Y ← L⁻¹Y, L lower triangular with rows at distances of n, and Y with rows at distances of `width`.  TOGETHER rows from
// `first` on matter up to column part(first), which is no more than of those before.
template <class Part>
inline void substitute(const double* L, int n, int count, double* Y, int width, Part part) {
    constexpr int BLOCKS = REGISTER == COLUMNS ? 2 : 1;  // what the registers hold
    for (int first = 0; first < count; first += TOGETHER) {
        int last = std::min(first + TOGETHER, count), columns = part(first), j = 0;
        double* block = Y + size_t(first) * width;
        bool whole = last - first == TOGETHER;
        if (whole) {
            for (; j + BLOCKS * COLUMNS <= columns; j += BLOCKS * COLUMNS)
                subtract_rows_from_all<BLOCKS>(block + j, Y + j, width, L + size_t(first) * n, n, first);
            for (; j < columns; j += COLUMNS) subtract_rows_from_all<1>(block + j, Y + j, width, L + size_t(first) * n, n, first);
        }
        for (int k = first; k < last; ++k) {
            double* y = Y + size_t(k) * width;
            const double* l = L + size_t(k) * n;
            int from = whole ? first : 0;
            subtract_rows(y, Y + size_t(from) * width, width, l + from, k - from, columns);
            scale_row(y, 1.0 / l[k], columns);
        }
    }
}

}  // namespace core
