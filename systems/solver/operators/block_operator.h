// The contact operator of general 3x3 blocks, in the frames of the contacts (normal, tangent 1, tangent 2): problems from files.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/options.h"
#include "components/types.h"
#include "systems/solver/operators/friction_law.h"
#include "systems/solver/operators/solve_block.h"

namespace skerry {

/// u = W r + q, W in compressed rows of blocks. W is used as given, also where it is not quite symmetric.
struct BlockSystem {
    std::span<const Index> row_offset;  // contacts + 1
    std::span<const Index> column;
    std::span<const Mat3> block;  // s/kg
    std::span<const Vec3> q;      // m/s
    std::span<const Real> mu;
};

/// Working memory for all contacts of a system.
struct BlockMemory {
    std::vector<LocalBlock> local;
    std::vector<Vec3> impulse;                   // N s, by contact of the system
    std::vector<Vec3> gathered;                  // N s, by contact of the region
    std::array<std::vector<Vec3>, 4> workspace;  // by contact of the region

    void prepare(const BlockSystem& system);
};

/// F_i for rho = 1: what the impulse lacks to answer its velocity, by the cone of FCLIB or by the paper's pyramid.
Vec3 natural_map(const Vec3& impulse, const Vec3& u, Real mu, Friction friction);

/// One region of a system: the contacts `row`, which no other region's rows refer to.
class BlockOperator {
public:
    using Vector = Vec3;

    /// `smallest_size`: the error is not measured against less than this; the region's share of a larger whole.
    BlockOperator(const BlockSystem& system, std::span<const Index> row, Friction friction, Real smallest_size, BlockMemory& memory);

    Index size() const { return static_cast<Index>(row_.size()); }
    /// By contact of the region; the system's impulses follow at refresh().
    std::span<Vec3> impulse() { return {memory_.gathered.data(), row_.size()}; }
    std::span<Vec3> workspace(Index slot) { return {memory_.workspace[slot].data(), row_.size()}; }
    void refresh();
    Real step(Index i, Real relaxation);
    /// |F| / max(|q|, |r|, |u|): the measure of FCLIB and Siconos (methods.md 2.1), of this region.
    Real error() const;
    bool suggests_check(Real, Real) const { return false; }  // rho = 1: the change of a sweep says little about this measure
    void residual(std::span<Vec3> out) const;
    void multiply(std::span<const Vec3> in, std::span<Vec3> out);
    Vec3 project(Index i, const Vec3& impulse) const;
    Vec3 feasible(Index i, const Vec3& residual) const;

private:
    Vec3 add_products(Index row, Vec3 start) const;
    Vec3 velocity(Index row) const { return add_products(row, system_.q[row]); }

    const BlockSystem& system_;
    std::span<const Index> row_;
    Friction friction_;
    Real smallest_size_;
    BlockMemory& memory_;
};

}  // namespace skerry
