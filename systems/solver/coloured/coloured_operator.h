// The contact operator of a large region: LumpedOperator's arithmetic in the order of a colouring, done by a team of workers. The bits are
// those of a LumpedOperator over the contacts in that order, but for the sums, which are taken block by block.
#pragma once

#include <algorithm>
#include <span>

#include "jobs/team.h"
#include "systems/solver/coloured/colour_contacts.h"
#include "systems/solver/operators/lumped_operator.h"

namespace skerry {

/// Rows by node, and by contact before there is an order, are done in blocks of this many.
inline constexpr std::size_t row_block = 256;

inline Index row_block_count(std::size_t rows) {
    return static_cast<Index>((rows + row_block - 1) / row_block);
}

/// body(begin, end, block) for blocks of row_block rows.
template <class Body>
void for_row_blocks(Team& team, std::size_t count, Body&& body) {
    team.run_blocks(row_block_count(count), [&](Index block) {
        const std::size_t begin = static_cast<std::size_t>(block) * row_block;
        body(begin, std::min(begin + row_block, count), block);
    });
}

/// body(begin, end, block) for the blocks of the order, phase after phase: also where the phases are of no matter, so that each worker
/// finds the contacts in its cache.
template <class Body>
void for_ordered_blocks(Team& team, const ColouredOrder& order, Body&& body) {
    team.run_phases(order.phase_offset.span(), [&](Index block) {
        body(static_cast<std::size_t>(order.block_offset[block]), static_cast<std::size_t>(order.block_offset[block + 1]), block);
    });
}

/// How many sums by block a region of this order needs.
inline std::size_t partial_count(const ColouredOrder& order) {
    return order.block_offset.size() - 1;
}

class ColouredOperator {
public:
    /// Contacts, impulses and workspaces by place in the order. `partial`: partial_count(order) rows. Velocities must be those of the
    /// impulse.
    ColouredOperator(const LumpedOperator::Memory& memory, const ColouredOrder& order, Team& team, std::span<SweepChange> partial,
                     Friction friction, Real scale)
        : memory_(memory),
          serial_(memory, friction, scale),
          order_(order),
          team_(team),
          partial_(partial),
          friction_(friction),
          scale_(scale) {}

    Index size() const { return serial_.size(); }
    std::span<Vec4> impulse() {
        settle();
        return memory_.impulse;
    }
    std::span<Vec4> workspace(Index slot) {
        settle();
        return memory_.workspace[slot];
    }
    void refresh() {
        settle();
        refresh(memory_.impulse, memory_.velocity);
    }
    void refresh_all();
    void remember();
    void extrapolate(Real factor);
    Real sweep(Real relaxation);
    SweepChange accelerated_sweep(Real relaxation);
    Real error();
    bool suggests_check(Real change, Real tolerance) const { return serial_.suggests_check(change, tolerance); }
    Real inner(Index i, const Vec4& a, const Vec4& b) const { return serial_.inner(i, a, b); }
    void residual(std::span<Vec4> out);
    void multiply(std::span<const Vec4> in, std::span<Vec4> out);
    Vec4 project(Index i, const Vec4& impulse) const { return serial_.project(i, impulse); }
    Vec4 feasible(Index i, const Vec4& residual) const { return serial_.feasible(i, residual); }
    Vec4 normal(Index i) const { return serial_.normal(i); }
    FrictionLimits limits(Index i) const { return serial_.limits(i); }
    Real mobility(Index i) const { return serial_.mobility(i); }
    Friction law() const { return serial_.law(); }
    void assemble(Eigen::MatrixXd& matrix) const { serial_.assemble(matrix); }

private:
    void refresh(std::span<const Vec4> impulse, std::span<Vec4> velocity);
    void settle();

    LumpedOperator::Memory memory_;
    LumpedOperator serial_;
    const ColouredOrder& order_;
    Team& team_;
    std::span<SweepChange> partial_;
    Friction friction_;
    Real scale_;
    // The impulses of an extrapolation wait for the next sweep, which passes over them anyway; its velocities are done.
    bool waiting_ = false;
    Real factor_ = 0;
};

}  // namespace skerry
