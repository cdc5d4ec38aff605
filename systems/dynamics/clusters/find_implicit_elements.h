// Finds the elements of a body that are unstable at a given step and makes them implicit (docs/methods/clusters.md 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/stability/stable_step.h"

namespace skerry {

/// Output columns of the search, with one row per element block of the body.
struct ImplicitOutputs {
    // Weight of an explicit element when the mass of a node is shared among its elements. It is 0 for implicit
    // elements, which get no mass.
    std::span<ElementLane> mass_share;
    std::span<ElementLane> modulus;  // assumed modulus of an implicit element; 0 for an explicit element [Pa]
};

struct ImplicitGoal {
    Real step;  // step at which the implicit elements are to be stable [s]
    // Stable step that every explicit element must reach with its mass share [s]. It is less than `step` if mass forms
    // (ElementBlockTable::mass_form), which are computed later, will allow longer steps.
    Real stable;
    Real stiffness_ratio;  // ratio of assumed to present stiffness of an implicit element, which may stiffen later
    Real max_moment;       // largest allowed ImplicitShare::moment; the search fails above it
    // Largest allowed number of nodes in a cluster; the search fails above it. 0: no limit. A limit requires
    // `inverse_mass` (by row of NodeTable, 0 for held nodes [1/kg]), because clusters contain only moving nodes.
    std::size_t max_nodes = 0;
    std::span<const Real> inverse_mass{};
};

struct ImplicitShare {
    Real moment = 0;  // moment of inertia added by the clusters, relative to the least principal moment of the body
    // True if the search failed because more than 3/4 of the volume would be implicit, or a cluster would have too many
    // nodes.
    bool too_many = false;
};

/// Searches for the implicit elements of a body at fixed node positions. find() can be called for any number of step
/// lengths. Data that do not depend on the step length are computed once, when they are first needed. All constructor
/// arguments must outlive the search, and only the output columns may change meanwhile. Sequential.
///
/// find() divides the mass of each node among its elements again and again. The rigorous bound on the stable step of an
/// element needs 9x9 matrices, so most rounds only estimate how the step changes with the divided masses. Let m_k be
/// the element's part of the mass of node k, and g_k the gradient of the shape function of node k. The step is nearly
/// proportional to 1/sqrt(T) with T = sum_k |g_k|^2 / m_k.
class ImplicitSearch {
public:
    /// `out` must refer to the columns that `elements` reads. `stiffness_sum` is work memory with one entry per node.
    ImplicitSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, const ImplicitOutputs& out,
                   const ElementBounds& bounds = {});

    /// Shares the masses of the body so that every explicit element is stable at a step of goal.stable, and makes as
    /// few elements implicit as necessary. The elements that need the largest fraction of the masses of their nodes
    /// become implicit first. The search stops when implicit elements have too much volume, add too much moment of
    /// inertia or form too large a cluster. The outputs are then invalid.
    ImplicitShare find(const ImplicitGoal& goal);

    /// Estimate of the fraction of the volume that must become implicit so that the remaining elements can be stable at
    /// a step of `stable` [s]: these need no more mass in total than the nodes have. The estimate takes much less time
    /// than find().
    Real estimate_volume(Real stable) const;

private:
    /// Pair of an element and one of its nodes. Pairs are listed by block, node of the block and lane, so that sums
    /// have a fixed order.
    struct Incidence {
        // `node`: row of NodeTable minus first_node_. `element`: lane of the element, counted through all blocks of the
        // body.
        Index node, element;
        Real size;  // squared length of the gradient of the element's shape function of this node [1/m^2]
    };
    // Bits of marks_: `near_unstable` marks the nodes of elements that are unstable at the required step,
    // `near_implicit` the nodes of implicit elements.
    static constexpr std::uint8_t near_unstable = 1, near_implicit = 2;

    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    Real& share(std::size_t b, std::size_t l) const { return out_.mass_share[row(b)][l]; }
    static Real& lane_value(std::vector<ElementLane>& column, Index element) {
        const auto e = static_cast<std::size_t>(element);
        return column[e / element_lanes][e % element_lanes];
    }
    /// Fraction of the masses of its nodes that an element needs to be stable at `step` [s]. If the fraction is above
    /// 1, no mass share can make the element stable.
    Real needed_fraction(std::size_t b, std::size_t l, Real step) const;
    /// Computes the data of find() that do not depend on the step length. Mass shares must still have their initial
    /// values (start_mass_shares()), because weight_per_share_ is divided by them and later shares may be 0.
    void prepare();
    void list_incidences();
    /// Computes the stable steps of all elements with their present mass shares by the rigorous bound.
    void measure();
    /// Estimates these stable steps. A stable step is nearly proportional to 1/sqrt(trace) (find_trace()), so the
    /// rigorous bound of the last measure() is scaled by sqrt(trace at that time / present trace).
    void estimate();
    /// Computes the trace T (see the class) for every element with a mass share, up to a factor that depends only on
    /// the shape. sum_ must contain the stiffness sums for the present mass shares.
    void find_trace(std::vector<ElementLane>& trace);
    void mark(std::size_t b, std::size_t l, std::uint8_t bits);
    /// Marks of an element: near_unstable if any of its nodes has this mark, and near_implicit if all of its nodes have
    /// this mark.
    std::uint8_t marks_of(std::size_t b, std::size_t l) const;
    /// Makes some of the elements implicit that are unstable at `step` or share a node with an unstable element:
    /// - those whose needed_fraction() is at least min_needed_fraction_;
    /// - those whose nodes all belong to implicit elements, because they enlarge no cluster.
    /// If there are no such elements, min_needed_fraction_ is lowered for the next call.
    void make_unstable_implicit(Real step);
    /// Writes the assumed moduli of the implicit elements. Returns the moment of inertia that they add, and whether
    /// they have too much volume or form too large a cluster.
    ImplicitShare add_implicit(const ImplicitGoal& goal);

    const ElementInputs elements_;
    Range blocks_;
    std::span<const Vec3> position_;
    std::span<const Real> mass_;
    std::span<Real> stiffness_sum_;
    ImplicitOutputs out_;
    ElementBounds bounds_;
    std::vector<Index> nodes_;  // nodes of all elements: rows of NodeTable, ascending
    Real least_moment_;         // least principal moment of inertia of the body [kg m^2]
    Index first_node_ = 0;
    std::vector<Incidence> incidences_;
    std::vector<ElementLane> frequency_;  // squared frequency of an element that has all mass of its nodes [1/s^2]
    std::vector<ElementLane> stiffness_;  // upper bound on the material Hessian in the shape `position_` [Pa]
    std::vector<ElementLane> weight_per_share_;  // stiffness_weight() of an element divided by its initial mass share
    // Values by element: stable step (step_), stable step at the last rigorous bound (measured_step_), trace at that
    // bound (measured_trace_), present trace (present_trace_), stiffness weight (weight_).
    std::vector<ElementLane> step_, measured_step_, measured_trace_, present_trace_, weight_;
    // For each node: sum of the stiffnesses of the elements at the node, and this sum divided by the mass of the node.
    std::vector<Real> sum_, ratio_;
    std::vector<std::uint8_t> marks_;  // by node
    Real min_needed_fraction_ = 1;
    bool step_is_rigorous_ = false;  // true if step_ holds the rigorous bound, not an estimate
};

/// Makes every explicit element implicit that is unstable at a step of goal.stable. It is faster than
/// ImplicitSearch::find(), but makes more elements implicit, because it keeps the mass shares and mass forms of all
/// other elements. Implicit elements stay implicit. Only the limit on the volume is tested (too_many).
ImplicitShare add_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> mass, const ImplicitGoal& goal, std::span<Real> stiffness_sum,
                                    const ImplicitOutputs& out, const ElementBounds& bounds);

}  // namespace skerry
