#include "systems/solver/equations/dense_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/lanes.h"

namespace skerry {
namespace {

constexpr Index panel = 8;  // number of columns that are factored one by one before the remaining columns are updated

Real8 load(const Real* from, Real8) {
    return *reinterpret_cast<const Real8InMemory*>(from);
}
void subtract(const Real8& value, Real* from) {
    const Real8 left = *reinterpret_cast<const Real8InMemory*>(from) - value;
    *reinterpret_cast<Real8InMemory*>(from) = left;
}
void store_value(const Real8& value, Real* to) {
    *reinterpret_cast<Real8InMemory*>(to) = value;
}
Real load(const Real* from, Real) {
    return *from;
}
void subtract(Real value, Real* from) {
    *from -= value;
}

/// Subtracts one register of a product of matrices from a column of c.
constexpr auto subtract_from = [](const auto& value, Real* from) { subtract(value, from); };
/// Subtracts only the last `count` entries of the register. It serves the last rows of c if they do not fill a
/// register: the register then begins with rows that are already done.
struct SubtractLastRows {
    Index count;

    void operator()(const Real8& value, Real* from) const {
        for (Index k = 8 - count; k < 8; ++k) from[k] -= value[k];
    }
};
/// Overwrites a column of c by one register of a product.
constexpr auto store = [](const Real8& value, Real* to) { store_value(value, to); };

/// Computes as many rows of the product a b as fill one register, from `row` on: 8 rows if Part is Real8, 1 row if Part
/// is Real. Passes each column of the result to `finish`, with the address of the same rows of c.
template <class Part>
void multiply_rows(const DenseBlock& a, const DenseBlock& b, const DenseBlock& c, Index row, const auto& finish) {
    const Real* const start = a.data + row;
    Index at = 0;
    for (; at + 4 <= c.columns; at += 4) {
        const Real *b0 = b.column(at), *b1 = b.column(at + 1), *b2 = b.column(at + 2), *b3 = b.column(at + 3);
        Part first{}, second{}, third{}, fourth{};
        const Real* from = start;
        for (Index k = 0; k < b.rows; ++k, from += a.stride) {
            const Part column = load(from, Part{});
            first += column * b0[k];
            second += column * b1[k];
            third += column * b2[k];
            fourth += column * b3[k];
        }
        finish(first, c.column(at) + row);
        finish(second, c.column(at + 1) + row);
        finish(third, c.column(at + 2) + row);
        finish(fourth, c.column(at + 3) + row);
    }
    for (; at < c.columns; ++at) {
        Part sum{};
        const Real *factor = b.column(at), *from = start;
        for (Index k = 0; k < b.rows; ++k, from += a.stride) sum += load(from, Part{}) * factor[k];
        finish(sum, c.column(at) + row);
    }
}

/// Smallest range [first, last) with all columns of a that have a nonzero entry in rows row .. row + 7.
std::pair<Index, Index> nonzero_columns(const DenseBlock& a, Index row) {
    const auto is_nonzero = [&](Index k) {
        const Real* const at = a.column(k) + row;
        return std::any_of(at, at + 8, [](Real x) { return x != 0; });
    };
    Index first = 0, last = a.columns;
    while (first < last && !is_nonzero(first)) ++first;
    while (last > first && !is_nonzero(last - 1)) --last;
    return {first, last};
}

void exchange_rows(const DenseBlock& block, Index from, Index to) {
    if (from == to) return;
    for (Index k = 0; k < block.columns; ++k) std::swap(block.column(k)[from], block.column(k)[to]);
}

/// Subtracts a multiple of a vector of length `count`: y -= factor x.
void subtract_scaled(Real factor, const Real* x, Real* y, Index count) {
    Index k = 0;
    for (; k + 8 <= count; k += 8) subtract(factor * load(x + k, Real8{}), y + k);
    for (; k < count; ++k) y[k] -= factor * x[k];
}

/// Factors the columns [begin, end) of a, and updates only these columns. But row exchanges apply to the whole matrix.
bool factor_panel(const DenseBlock& a, Index begin, Index end, Index* pivot) {
    for (Index k = begin; k < end; ++k) {
        Real* const column = a.column(k);
        const auto largest =
            std::max_element(column + k, column + a.rows, [](Real x, Real y) { return std::abs(x) < std::abs(y); });
        pivot[k] = static_cast<Index>(largest - column);
        if (!(std::abs(*largest) > 0) || !std::isfinite(*largest)) return false;
        exchange_rows(a, k, pivot[k]);
        const Real inverse = 1 / column[k];
        for (Index i = k + 1; i < a.rows; ++i) column[i] *= inverse;
        for (Index j = k + 1; j < end; ++j)
            subtract_scaled(a.column(j)[k], column + k + 1, a.column(j) + k + 1, a.rows - k - 1);
    }
    return true;
}

/// Inverse of a triangular diagonal block with `panel` columns. With it, the solution for many right-hand columns
/// becomes a matrix product in registers.
struct TriangleInverse {
    static_assert(panel == 8);
    alignas(Real8) Real number[panel * panel] = {};  // column by column

    Real* column(Index k) { return number + k * panel; }
    static TriangleInverse lower(const DenseBlock& factors, Index begin) {
        TriangleInverse inverse;
        for (Index c = 0; c < panel; ++c) {
            Real* const x = inverse.column(c);
            x[c] = 1;
            for (Index k = c; k < panel; ++k)
                for (Index i = k + 1; i < panel; ++i) x[i] -= factors.column(begin + k)[begin + i] * x[k];
        }
        return inverse;
    }
    static TriangleInverse upper(const DenseBlock& factors, Index begin) {
        TriangleInverse inverse;
        for (Index c = 0; c < panel; ++c) {
            Real* const x = inverse.column(c);
            x[c] = 1;
            for (Index k = c + 1; k-- > 0;) {
                x[k] /= factors.column(begin + k)[begin + k];
                for (Index i = 0; i < k; ++i) x[i] -= factors.column(begin + k)[begin + i] * x[k];
            }
        }
        return inverse;
    }
    /// Replaces b by the inverse of the triangle times b. The product may overwrite b, because the columns of b are
    /// read four at a time before they are written.
    void multiply(const DenseBlock& b) { multiply_rows<Real8>({number, panel, panel, panel}, b, b, 0, store); }
};
constexpr Index many_columns = panel;  // least number of right-hand columns for which TriangleInverse pays off

/// b = L^-1 b, where L is the unit lower triangle in the rows and columns [begin, end) of `factors`.
void solve_lower(const DenseBlock& factors, Index begin, Index end, const DenseBlock& b, bool many) {
    if (end - begin == panel && many) {
        TriangleInverse::lower(factors, begin).multiply(b.part(begin, 0, panel, b.columns));
        return;
    }
    for (Index c = 0; c < b.columns; ++c) {
        Real* const x = b.column(c);
        for (Index k = begin; k < end; ++k) subtract_scaled(x[k], factors.column(k) + k + 1, x + k + 1, end - k - 1);
    }
}
void solve_upper(const DenseBlock& factors, Index begin, Index end, const DenseBlock& b, bool many) {
    if (end - begin == panel && many) {
        TriangleInverse::upper(factors, begin).multiply(b.part(begin, 0, panel, b.columns));
        return;
    }
    for (Index c = 0; c < b.columns; ++c) {
        Real* const x = b.column(c);
        for (Index k = end - 1; k >= begin; --k) {
            x[k] /= factors.column(k)[k];
            subtract_scaled(x[k], factors.column(k) + begin, x + begin, k - begin);
        }
    }
}

/// Calls visit(begin, count) for the ranges of columns of b between gaps of at least eight consecutive zero columns.
/// Zero columns belong to nodes whose contacts are all open, since such nodes do not couple to other bodies.
void for_each_run_of_columns(const DenseBlock& b, auto&& visit) {
    constexpr Index gap = 8;
    const auto is_nonzero = [&](Index k) {
        const Real* const at = b.column(k);
        return std::any_of(at, at + b.rows, [](Real x) { return x != 0; });
    };
    Index begin = 0, end = 0;
    for (Index k = 0; k < b.columns; ++k) {
        if (!is_nonzero(k)) continue;
        if (k - end >= gap || end == 0) {
            if (end > begin) visit(begin, end - begin);
            begin = k;
        }
        end = k + 1;
    }
    if (end > begin) visit(begin, end - begin);
}

void subtract_dense_product(const DenseBlock& a, const DenseBlock& b, const DenseBlock& c) {
    Index row = 0;
    for (; row + 8 <= c.rows; row += 8) {
        // Only a few consecutive columns of a are nonzero in the eight rows from `row` on, because contacts couple each
        // node of a face to a few consecutive nodes of the other face.
        const auto [first, last] = nonzero_columns(a, row);
        multiply_rows<Real8>(a.part(0, first, a.rows, last - first), b.part(first, 0, last - first, b.columns), c, row,
                             subtract_from);
    }
    if (row < c.rows && c.rows >= 8)
        multiply_rows<Real8>(a, b, c, c.rows - 8, SubtractLastRows{c.rows - row});
    else
        for (; row < c.rows; ++row) multiply_rows<Real>(a, b, c, row, subtract_from);
}

void solve_all(const DenseBlock& factors, const Index* pivot, const DenseBlock& b, bool many) {
    const Index size = factors.rows;
    for (Index k = 0; k < size; ++k) exchange_rows(b, k, pivot[k]);
    for (Index begin = 0; begin < size; begin += panel) {
        const Index end = std::min(begin + panel, size);
        solve_lower(factors, begin, end, b, many);
        subtract_dense_product(factors.part(end, begin, size - end, end - begin),
                               b.part(begin, 0, end - begin, b.columns), b.part(end, 0, size - end, b.columns));
    }
    for (Index end = size; end > 0;) {
        const Index begin = (end - 1) / panel * panel;
        solve_upper(factors, begin, end, b, many);
        subtract_dense_product(factors.part(0, begin, begin, end - begin), b.part(begin, 0, end - begin, b.columns),
                               b.part(0, 0, begin, b.columns));
        end = begin;
    }
}

}  // namespace

void subtract_product(const DenseBlock& a, const DenseBlock& b, const DenseBlock& c) {
    for_each_run_of_columns(b, [&](Index begin, Index count) {
        subtract_dense_product(a, b.part(0, begin, b.rows, count), c.part(0, begin, c.rows, count));
    });
}

void add_product(const DenseBlock& shape, const Real* numbers, const Real* x, Real* y) {
    const auto column = [&](Index k) { return numbers + k * shape.stride; };
    Index at = 0;
    for (; at + 4 <= shape.columns; at += 4) {
        const auto sum_of_row = [&]<class Part>(Index row, Part sum) {
            for (Index k = at; k < at + 4; ++k) sum += load(column(k) + row, Part{}) * x[k];
            return sum;
        };
        Index row = 0;
        for (; row + 8 <= shape.rows; row += 8) store_value(sum_of_row(row, load(y + row, Real8{})), y + row);
        for (; row < shape.rows; ++row) y[row] = sum_of_row(row, y[row]);
    }
    for (; at < shape.columns; ++at) subtract_scaled(-x[at], column(at), y, shape.rows);
}

bool factor_dense(const DenseBlock& a, Index* pivot) {
    const Index size = a.rows;
    for (Index begin = 0; begin < size; begin += panel) {
        const Index end = std::min(begin + panel, size), rest = size - end;
        if (!factor_panel(a, begin, end, pivot)) return false;
        if (rest == 0) break;
        solve_lower(a, begin, end, a.part(0, end, size, rest), rest >= many_columns);
        subtract_product(a.part(end, begin, rest, end - begin), a.part(begin, end, end - begin, rest),
                         a.part(end, end, rest, rest));
    }
    return true;
}

void solve_dense(const DenseBlock& factors, const Index* pivot, const DenseBlock& b) {
    // Triangle inverses are used if b has many columns in total, whatever the lengths of the ranges of nonzero columns.
    // So the bits of the result do not depend on which columns are zero.
    const bool many = b.columns >= many_columns;
    for_each_run_of_columns(
        b, [&](Index begin, Index count) { solve_all(factors, pivot, b.part(0, begin, b.rows, count), many); });
}

}  // namespace skerry
