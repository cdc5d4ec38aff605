// Delassus operator W made of general 3x3 blocks, in the contact frames (normal, tangent 1, tangent 2). It is used for
// problems read from files.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/column.h"
#include "components/options.h"
#include "components/types.h"
#include "systems/solver/local/columns3.h"
#include "systems/solver/local/solve_block.h"
#include "systems/solver/operators/contact_operator.h"
#include "systems/solver/operators/newton_memory.h"

namespace skerry {

/// Contact problem u = W r + q with W in compressed rows of blocks. W is used as given, even if it is slightly
/// asymmetric.
struct BlockSystem {
    std::span<const Index> row_offset;  // index of the first block of each row; contact count + 1 entries
    std::span<const Index> column;
    std::span<const Mat3> block;  // [1/kg]
    std::span<const Vec3> q;      // [m/s]
    std::span<const Real> mu;
};

/// A contact problem in the order of the sweep. Data are contiguous. Vectors are padded to vector registers by a fourth
/// entry, which is zero.
struct BlockMemory {
    struct Contact {
        Vec4 q;
        std::array<Vec4, 3> diagonal;  // columns of W_ii
        std::array<Vec4, 3> skew;  // half of W_ii - W_ii^T: skew part of the diagonal block, which solve_block ignores
        LocalBlock local;
        Real mu;
    };
    using Columns = Columns3;

    std::vector<Contact> contact;
    std::vector<Index> offset;    // index of the first off-diagonal block of each contact; contact count + 1 entries
    std::vector<Index> neighbor;  // for each off-diagonal block W_ij: index of contact j in the sweep order
    std::vector<Columns> block;   // off-diagonal blocks W_ij
    std::vector<Vec4> impulse;    // [N s]
    std::array<std::vector<Vec4>, workspace_limit> workspace;
    NewtonMemory newton;

    /// `order` lists the contacts of the system in the order of the sweep. Contacts of a region must be consecutive.
    /// Impulses start at zero.
    void prepare(const BlockSystem& system, std::span<const Index> order);
};

/// Residual of the friction law of a contact with the impulse r and the velocity u: r minus a projection onto the
/// admissible impulses. It is zero for a solution. It is the natural map with the factor 1 instead of 1/D_i
/// (docs/methods/errors.md 3). `friction`:
/// - cone of FCLIB: r - u - mu |u_t| n is projected
/// - pyramid: that of Lazarevych et al. (2010)
Vec3 natural_map(const Vec3& impulse, const Vec3& u, Real mu, Friction friction);

/// Operator of one region: the contacts [begin, end) of `memory`. No block of W may couple these contacts to contacts
/// of other regions.
class BlockOperator {
public:
    using Number = Real;

    /// `smallest_size` is a lower bound of the norm by which the error is divided. For one region of a larger problem
    /// it is the share of this region in the norm of the problem; otherwise it is 0.
    BlockOperator(BlockMemory& memory, Index begin, Index end, Friction friction, Real smallest_size);

    Index size() const { return end_ - begin_; }
    std::span<Vec4> impulse() { return part(memory_.impulse); }
    std::span<Vec4> workspace(Index slot) { return part(memory_.workspace[slot]); }
    void refresh() {}
    void refresh_all() {}
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    Real inner(Index i, const Vec4& a, const Vec4& b) const {
        const BlockMemory::Columns& w = memory_.contact[begin_ + i].diagonal;
        return a.dot(w[0] * b[0] + w[1] * b[1] + w[2] * b[2]);
    }
    /// Relative error |F| / max(|q|, |r|, |u|) of this region: the measure of FCLIB and Siconos (docs/methods/errors.md
    /// 3).
    Real error();
    /// Norm max(|q|, |r|, |u|) in the last call of error().
    Real measured_size() const { return size_; }
    bool suggests_check(Real change, Real tolerance);
    void remember();
    void extrapolate(Real factor);
    void residual(std::span<Vec4> out) const;
    void multiply(std::span<const Vec4> in, std::span<Vec4> out) const;
    Vec4 project(Index i, const Vec4& impulse) const;
    Vec4 feasible(Index i, const Vec4& residual) const;
    Vec4 normal(Index) const { return Vec4::UnitX(); }
    FrictionLimits limits(Index i) const { return {memory_.contact[begin_ + i].mu, memory_.contact[begin_ + i].mu}; }
    Real mobility(Index i) const {
        const BlockMemory::Columns& w = memory_.contact[begin_ + i].diagonal;
        return (w[0][0] + w[1][1] + w[2][2]) / 3;
    }
    Friction law() const { return friction_; }
    NewtonMemory& newton_memory() { return memory_.newton; }
    Index couplings() const { return memory_.offset[end_] - memory_.offset[begin_]; }
    void assemble(Eigen::MatrixXd& matrix) const;

private:
    Real step(Index i, Real relaxation);
    std::span<Vec4> part(std::vector<Vec4>& all) const {
        return {all.data() + begin_, static_cast<std::size_t>(end_ - begin_)};
    }
    Vec4 velocity(Index index) const;

    BlockMemory& memory_;
    Index begin_, end_;
    Friction friction_;
    Real smallest_size_;
    Real swept_ = 0;        // estimate of |F|^2, with the natural map F, from the changes of the present sweep
    Real last_swept_ = 0;   // estimate of |F|^2 from the changes of the last complete sweep
    Real calibration_ = 1;  // measured |F|^2 divided by the estimate, at the last measurement
    Real size_ = 0;         // max(|q|, |r|, |u|) at the last measurement
};

}  // namespace skerry
