// Finds the elements of a body that are not stable at a step and become implicit (docs/methods/clusters.md 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Output columns, by block of the body.
struct ImplicitOutputs {
    std::span<ElementLane> mass_share;  // 0 for implicit elements: they take no mass from their nodes
    std::span<ElementLane> modulus;     // assumed stiffness of an implicit element; 0: explicit [Pa]
};

struct ImplicitGoal {
    Real step;         // step of the clusters [s]
    Real stands;       // required stable step of explicit elements by shares; below `step` if mass forms follow [s]
    Real headroom;     // assumed stiffness of implicit elements over their present stiffness
    Real most_moment;  // limit of ImplicitShare::moment; the search fails above it
};

struct ImplicitShare {
    Real moment = 0;        // moment of inertia that the clusters add, over the least moment of the body
    bool too_many = false;  // more than three quarters of the volume would be implicit: the search fails
};

/// Searches for the implicit elements of a body in one shape, for any number of steps. Data that do not depend on the
/// step are computed once. All arguments must outlive the search, and only the outputs may change. Sequential.
///
/// The bound on the step of an element takes 9x9 matrices. Its change with the masses closely follows that of the trace
/// of sum_k g_k g_k^T / m_k, which takes one product per node. Most rounds use the trace.
class ImplicitSearch {
public:
    /// The columns of `out` must be those that `elements` reads. `stiffness_sum` is scratch, one entry per node.
    ImplicitSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, const ImplicitOutputs& out);

    /// Shares the masses of the body anew, so that every explicit element is stable at goal.stands, and makes as few
    /// elements implicit as necessary. Those that need most of the masses of their nodes go first. Stops as soon as
    /// these are too many or add too much to the moment; the outputs are invalid then.
    ImplicitShare find(const ImplicitGoal& goal);

private:
    /// A node of an element. Listed by block, node of the block and lane, so that sums have a fixed order.
    struct Hold {
        Index node, element;  // numbered from the first of the body
        Real size;            // squared length of the gradient [1/m^2]
    };
    // marks of the nodes of elements that are not stable at the step, and of implicit elements
    static constexpr std::uint8_t some_starved = 1, of_implicit = 2;

    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    Real& share(std::size_t b, std::size_t l) const { return out_.mass_share[row(b)][l]; }
    static Real& of(std::vector<ElementLane>& column, Index element) {
        const auto e = static_cast<std::size_t>(element);
        return column[e / element_lanes][e % element_lanes];
    }
    /// Fraction of the masses of its nodes that an element needs to be stable at `step`.
    Real need(std::size_t b, std::size_t l, Real step) const;
    void list_holds();
    /// Stable steps of the elements with their present shares: by the bound, or estimated from the last bound.
    void measure();
    void estimate();
    /// Trace of sum_k g_k g_k^T / m_k of elements that share masses, up to a factor that depends on the shape only.
    void find_trace(std::vector<ElementLane>& trace);
    void mark(std::size_t b, std::size_t l, std::uint8_t with);
    /// Contains some_starved if some node of the element has that mark, and of_implicit if all nodes have it.
    std::uint8_t marks_of(std::size_t b, std::size_t l) const;
    /// Makes elements implicit that share nodes with one that is not stable at `step`: those with the greatest need,
    /// and those without a node outside of clusters, which cost nothing. If there is none, lowers the limit of need.
    void give_up(Real step);
    ImplicitShare added(const ImplicitGoal& goal) const;

    const ElementInputs elements_;
    Range blocks_;
    std::span<const Vec3> position_;
    std::span<const Real> mass_;
    std::span<Real> stiffness_sum_;
    ImplicitOutputs out_;
    std::vector<Index> nodes_;  // of the elements
    Real least_moment_;         // kg m^2
    Index first_node_ = 0;
    std::vector<Hold> holds_;
    std::vector<ElementLane> frequency_;                               // squared, with all mass of its nodes [1/s^2]
    std::vector<ElementLane> stiffness_;                               // Pa
    std::vector<ElementLane> unit_;                                    // stiffness_weight over the mass share
    std::vector<ElementLane> step_, measured_, trace_, now_, weight_;  // for the present shares
    std::vector<Real> sum_, ratio_;                                    // by node: sum of stiffness; that over mass
    std::vector<std::uint8_t> marks_;                                  // by node
    Real least_need_ = 1;
    bool exact_ = false;  // true if step_ is the bound, not an estimate
};

/// Makes every explicit element implicit that is not stable at goal.stands. Implicit elements stay implicit; mass
/// shares and mass forms of the others stay as they are. This is fast, but finds more elements than a new sharing of
/// masses would. It ignores goal.most_moment.
ImplicitShare add_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> mass, const ImplicitGoal& goal, std::span<Real> stiffness_sum,
                                    const ImplicitOutputs& out);

}  // namespace skerry
