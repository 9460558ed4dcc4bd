// Rows of matrices, eight columns at a time.  Sums over columns go in one order on every processor.
#pragma once

#include "../values/lanes.hpp"

namespace core {

constexpr int COLUMNS = 8;
using Columns = Lanes<COLUMNS>;

inline int padded(int n) { return (n + COLUMNS - 1) / COLUMNS * COLUMNS; }

CORE_INLINE double sum(Columns x) {
    double part[COLUMNS];
    x.store(part);
    return ((part[0] + part[4]) + (part[2] + part[6])) + ((part[1] + part[5]) + (part[3] + part[7]));
}

// target −= Σ_i factors[i] · row i, i < count, over `width` columns (a multiple of COLUMNS).
inline void subtract_rows(double* target, const double* rows, int stride, const double* factors, int count, int width) {
    int j = 0;
    for (; j + 4 * COLUMNS <= width; j += 4 * COLUMNS) {
        Columns a = Columns::load(target + j), b = Columns::load(target + j + COLUMNS);
        Columns c = Columns::load(target + j + 2 * COLUMNS), d = Columns::load(target + j + 3 * COLUMNS);
        for (int i = 0; i < count; ++i) {
            const double* row = rows + size_t(i) * stride + j;
            Columns f = factors[i];
            a = a - f * Columns::load(row), b = b - f * Columns::load(row + COLUMNS);
            c = c - f * Columns::load(row + 2 * COLUMNS), d = d - f * Columns::load(row + 3 * COLUMNS);
        }
        a.store(target + j), b.store(target + j + COLUMNS);
        c.store(target + j + 2 * COLUMNS), d.store(target + j + 3 * COLUMNS);
    }
    for (; j < width; j += COLUMNS) {
        Columns a = Columns::load(target + j);
        for (int i = 0; i < count; ++i) a = a - Columns(factors[i]) * Columns::load(rows + size_t(i) * stride + j);
        a.store(target + j);
    }
}

inline void scale_row(double* row, double factor, int width) {
    for (int j = 0; j < width; j += COLUMNS) {
        Columns scaled = factor * Columns::load(row + j);
        scaled.store(row + j);
    }
}

}  // namespace core
