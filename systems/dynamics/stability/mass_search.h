// Common parts of the searches for the mass shares of elements (mass_forms.h, frame_masses.h).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "components/column.h"
#include "components/ragged.h"
#include "jobs/function_ref.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/material/relaxation.h"

namespace skerry {

inline LaneSymmetric<Real8> load_form(const ElementForm& form) {
    return {load(form[0]), load(form[1]), load(form[2]), load(form[3]), load(form[4]), load(form[5])};
}

inline LaneSymmetric<Real8> inverse_of(const LaneSymmetric<Real8>& s) {
    const Real8 xx = s.yy * s.zz - s.yz * s.yz, xy = s.zx * s.yz - s.xy * s.zz, zx = s.xy * s.yz - s.zx * s.yy;
    const Real8 scale = 1.0 / (s.xx * xx + s.xy * xy + s.zx * zx);
    return {scale * xx, scale * (s.xx * s.zz - s.zx * s.zx), scale * (s.xx * s.yy - s.xy * s.xy),
            scale * xy, scale * (s.xy * s.zx - s.xx * s.yz), scale * zx};
}

/// Moduli of the explicit finite elements of a body at rest. They include the springs of viscoelastic materials
/// (generalised Maxwell model). The longer the step, the more these springs relax and the less they contribute.
///
/// The assumed step is `longer` times a simple estimate of the stable step. This estimate follows from the greatest of
/// the frequencies that the finite elements would have if each were alone.
class RestModuli {
public:
    RestModuli(const ElementInputs& elements, Range blocks, Real longer);

    /// 1 for an explicit element, 0 for an implicit one. Implicit elements belong to clusters and get no mass share.
    Real8 explicit_mask(std::size_t block) const;

    struct Moduli {
        Real8 shear, volumetric;  // moduli 2 mu and lambda [Pa]
    };
    Moduli moduli(std::size_t block) const;

private:
    const ElementInputs& elements_;
    Real stiffest_ = 0;  // greatest modulus [Pa]
    // Step length that determines the relaxed stiffness of the springs of viscoelastic materials [s]
    Real relaxing_step_ = 0;
};

/// Sorts nodes by position along the longest side of their bounding box.
void sort_along(std::span<const Vec3> position, std::span<Index> nodes);

/// Corner of an element: the element in lane `lane` of block `block`, and the number of the corner.
struct ElementCorner {
    std::size_t block, lane;
    Index corner;
};

/// Lists the element corners at each node, in the order of elements. `nodes`: number of nodes. for_each_corner(visit)
/// must call visit(node, corner) for all corners, in the order of elements; `node` is the number of the node.
inline Ragged<ElementCorner> corners_at(std::size_t nodes, auto&& for_each_corner) {
    Ragged<ElementCorner> corners;
    corners.offset.resize(nodes + 1);
    for_each_corner([&](std::size_t node, const ElementCorner&) { ++corners.offset[node + 1]; });
    for (std::size_t i = 0; i < nodes; ++i) corners.offset[i + 1] += corners.offset[i];
    corners.item.resize(static_cast<std::size_t>(corners.offset[nodes]));
    std::vector<Index> next(corners.offset.begin(), corners.offset.end());
    for_each_corner([&](std::size_t node, const ElementCorner& corner) {
        corners.item[static_cast<std::size_t>(next[node]++)] = corner;
    });
    return corners;
}

/// Symmetric band matrix: all entries outside a band around the diagonal are zero. A row is stored from the diagonal to
/// the end of the band. Rows are computed in groups, each when it is needed.
struct BandMatrix {
    std::size_t size;   // number of rows, a multiple of `group`
    std::size_t width;  // number of entries stored per row
    std::size_t group;  // number of rows per group
    /// Adds the entries of the rows of a group to `rows`, which contains zeros. Each row begins `stride` numbers after
    /// the previous row.
    FunctionRef<void(std::size_t group_index, Real* rows, std::size_t stride)> add_rows;
};

/// Tests whether all eigenvalues of a band matrix are below a limit: then limit I - matrix, with the identity I, has a
/// Cholesky decomposition with pivots above rounding errors. A window that moves along the diagonal stores only rows
/// that influence each other.
class BandDecomposition {
public:
    bool is_below(const BandMatrix& matrix, Real limit);

private:
    // number of pivot rows used at once; each later row is loaded and stored once for all four of them
    static constexpr std::size_t pivots = 4;
    static constexpr std::size_t row_step = 8;  // number of entries in the widest register

    /// Consecutive pivot rows, beginning with row `first`. Each row begins at its diagonal.
    struct Pivots {
        std::size_t first;
        std::array<Real*, pivots> row{};
        std::array<Real, pivots> inverse{};
        std::size_t end;  // end of the columns that the pivot rows reach

        Real factor(std::size_t p, std::size_t r) const { return row[p][r - (first + p)] * inverse[p]; }
        bool reach(std::size_t r) const;
        const Real* column(std::size_t p, std::size_t c) const {
            return row[p] + (static_cast<std::ptrdiff_t>(c) - static_cast<std::ptrdiff_t>(first + p));
        }
    };
    void load_group(const BandMatrix& matrix, std::size_t group_index, Real limit);
    /// subtract_pivots() subtracts multiples of the pivot rows from row r. subtract_pivots_from_two() does the same for
    /// rows r and r + 1, but loads the pivot rows only once.
    void subtract_pivots(const Pivots& pivot, std::size_t r);
    void subtract_pivots_from_two(const Pivots& pivot, std::size_t r);
    /// Pointer to the diagonal entry of row r. Rows begin at such addresses that the entries of one column are in the
    /// same lane of a register in all rows. So rows can be subtracted register by register.
    Real* row(std::size_t r) { return &window_[(r % rows_) * stride_ + r % row_step]; }

    std::size_t rows_ = 0, stride_ = 0;  // number of rows in the window, and number of entries per row
    Column<Real> window_;
    std::vector<Real> rows_of_group_;
    std::vector<std::size_t> used_;  // number of used entries in each row of the window; zeros follow
};

}  // namespace skerry
