// Finds the elements of a body that are unstable at a given step and makes them implicit (docs/methods/clusters.md 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Output columns of the search, with one row per element block of the body.
struct ImplicitOutputs {
    // Weight of an element when the masses of nodes are shared; 0 for implicit elements, which take no mass.
    std::span<ElementLane> mass_share;
    std::span<ElementLane> modulus;  // assumed stiffness of an implicit element; 0 for an explicit element [Pa]
};

struct ImplicitGoal {
    Real step;  // step for which the clusters are made [s]
    // Required stable step of explicit elements with shared masses. It is below `step` if mass forms, computed later,
    // allow longer steps [s].
    Real stands;
    Real headroom;     // ratio of the assumed to the present stiffness of implicit elements
    Real most_moment;  // largest allowed ImplicitShare::moment; the search fails above it
};

struct ImplicitShare {
    Real moment = 0;        // moment of inertia added by the clusters, relative to the least moment of the body
    bool too_many = false;  // the search failed: more than 3/4 of the volume would be implicit
};

/// Searches for the implicit elements of a body in one shape. find() can be called for any number of step lengths; data
/// that do not depend on the step length are computed once. All constructor arguments must outlive the search, and only
/// the output columns may change meanwhile. Sequential.
///
/// The rigorous bound on the stable step of an element needs 9x9 matrices. Most rounds therefore estimate the change of
/// the bound with the masses: the step is nearly proportional to 1/sqrt(T) with the trace T of sum_k g_k g_k^T / m_k.
/// g_k is the shape gradient and m_k the element's mass share at node k. The trace takes one product per node.
class ImplicitSearch {
public:
    /// `out` must refer to the columns that `elements` reads. `stiffness_sum` is work memory with one entry per node.
    ImplicitSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, const ImplicitOutputs& out);

    /// Shares the masses of the body so that every explicit element is stable at goal.stands, and makes as few elements
    /// implicit as necessary. Elements that need the largest fraction of the masses of their nodes become implicit
    /// first. The search stops when implicit elements have too much volume or add too much moment of inertia. The
    /// outputs are then invalid.
    ImplicitShare find(const ImplicitGoal& goal);

private:
    /// Pair of an element and one of its nodes. Pairs are listed by block, node of the block and lane, so that sums
    /// have a fixed order.
    struct Hold {
        Index node, element;  // counted from the first node and the first element lane of the body
        Real size;            // squared length of the shape gradient [1/m^2]
    };
    // Bits of marks_: `some_starved` marks the nodes of elements that are unstable at the step, `of_implicit` the nodes
    // of implicit elements.
    static constexpr std::uint8_t some_starved = 1, of_implicit = 2;

    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    Real& share(std::size_t b, std::size_t l) const { return out_.mass_share[row(b)][l]; }
    static Real& of(std::vector<ElementLane>& column, Index element) {
        const auto e = static_cast<std::size_t>(element);
        return column[e / element_lanes][e % element_lanes];
    }
    /// Fraction of the masses of its nodes that an element needs to be stable at `step`. Above 1 no sharing can make
    /// the element stable.
    Real need(std::size_t b, std::size_t l, Real step) const;
    void list_holds();
    /// measure() and estimate() compute the stable steps of all elements with their present mass shares: by the
    /// rigorous bound, or by the change of the trace since the last rigorous bound.
    void measure();
    void estimate();
    /// Computes the trace of sum_k g_k g_k^T / m_k for every element with a mass share, up to a factor that depends
    /// only on the shape. g_k is the shape gradient and m_k the element's mass share at node k.
    void find_trace(std::vector<ElementLane>& trace);
    void mark(std::size_t b, std::size_t l, std::uint8_t with);
    /// Marks of an element: some_starved if any of its nodes has this mark, and of_implicit if all of its nodes have
    /// this mark.
    std::uint8_t marks_of(std::size_t b, std::size_t l) const;
    /// Makes elements implicit that share a node with an element unstable at `step`. Candidates are elements whose need
    /// is at least least_need_, and elements whose nodes all belong to implicit elements, because they enlarge no
    /// cluster. If there is no candidate, lowers least_need_.
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
    std::vector<ElementLane> frequency_;  // squared, with all mass of the nodes [1/s^2]
    std::vector<ElementLane> stiffness_;  // Pa
    std::vector<ElementLane> unit_;       // stiffness_weight() divided by the mass share
    // Values by element: stable step, step at the last rigorous bound, trace at that bound, present trace, stiffness
    // weight.
    std::vector<ElementLane> step_, measured_, trace_, now_, weight_;
    // Sum of the element stiffnesses at each node, and this sum divided by the node's mass.
    std::vector<Real> sum_, ratio_;
    std::vector<std::uint8_t> marks_;  // by node
    Real least_need_ = 1;
    bool exact_ = false;  // true if step_ holds the rigorous bound, not an estimate
};

/// Makes every explicit element implicit that is unstable at goal.stands. Implicit elements stay implicit, and the mass
/// shares and mass forms of all other elements are unchanged. This is faster than ImplicitSearch::find(), but makes
/// more elements implicit because masses are not shared anew. goal.most_moment is ignored.
ImplicitShare add_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> mass, const ImplicitGoal& goal, std::span<Real> stiffness_sum,
                                    const ImplicitOutputs& out);

}  // namespace skerry
