// Which elements of a body do not stand a step, and are left to clusters (docs/methods/clusters.md 3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// What is written of each block of the body.
struct ImplicitOutputs {
    std::span<ElementLane> mass_share;  // of implicit elements 0: they take no mass from their nodes
    std::span<ElementLane> modulus;     // Pa, stiffness that an implicit element is taken to have; 0: explicit
};

struct ImplicitGoal {
    Real step;         // s, of the clusters
    Real stands;       // s, what explicit elements are to stand: by shares, less than `step` where they get forms then
    Real headroom;     // stiffness that implicit elements are taken to have, over that which they have now
    Real most_moment;  // of ImplicitShare: nothing is found that adds more
};

struct ImplicitShare {
    Real moment = 0;        // what the clusters add to the least moment of inertia of the body, over that moment
    bool too_many = false;  // three quarters of the volume do not stand the step: nothing is found
};

/// Looks for implicit elements of a body in one shape, for any number of steps. What does not depend on the step is
/// found once. All that is given stays there, and but for the outputs as it is, while it searches. Sequential.
///
/// The bound on the step of an element is 9x9 matrices; how it changes with the masses follows that of the trace of
/// sum_k g_k g_k^T / m_k closely, which is one product a node, and is what most rounds go by.
class ImplicitSearch {
public:
    /// `mass_share` and `modulus` of the outputs are those of the inputs. `stiffness_sum` is scratch, one entry a node.
    ImplicitSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Real> mass, std::span<Real> stiffness_sum, const ImplicitOutputs& out);

    /// Shares the masses of the body anew, so that every explicit element stands what it is to, and makes implicit as
    /// few as it takes: those that need most of the masses of their nodes go first. Ends as soon as these are too many
    /// or add more to the moment than they may; what it has written by then is of no use.
    ImplicitShare find(const ImplicitGoal& goal);

private:
    /// A node that an element holds, by block, node of the block, and lane: sums over them have one order.
    struct Hold {
        Index node, element;  // from the first of the body on
        Real size;            // 1/m^2, of the gradient squared
    };
    static constexpr std::uint8_t some_starved = 1, of_implicit = 2;  // marks of nodes

    std::size_t row(std::size_t b) const { return b - static_cast<std::size_t>(blocks_.begin); }
    Real& share(std::size_t b, std::size_t l) const { return out_.mass_share[row(b)][l]; }
    static Real& of(std::vector<ElementLane>& column, Index element) {
        const auto e = static_cast<std::size_t>(element);
        return column[e / element_lanes][e % element_lanes];
    }
    /// Part of the masses of its nodes with which an element stands the step.
    Real need(std::size_t b, std::size_t l, Real step) const;
    void list_holds();
    /// Steps of the elements with the shares that they have: by the bound, or from what it was last.
    void measure();
    void estimate();
    /// Of elements that share masses, but for a factor that stays what it is while the shape does.
    void find_trace(std::vector<ElementLane>& trace);
    void mark(std::size_t b, std::size_t l, std::uint8_t with);
    /// some_starved: some node of the element is marked so; of_implicit: all are.
    std::uint8_t marks_of(std::size_t b, std::size_t l) const;
    /// Elements beside those that do not stand the step become implicit: those that need the most, and those that have
    /// no node outside of clusters, which cost nothing. Asks for less where that is none.
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
    std::vector<ElementLane> frequency_;                               // 1/s^2, squared: of each element alone
    std::vector<ElementLane> stiffness_;                               // Pa
    std::vector<ElementLane> unit_;                                    // stiffness_weight over the share
    std::vector<ElementLane> step_, measured_, trace_, now_, weight_;  // of the present shares
    std::vector<Real> sum_, ratio_;                                    // by node: stiffness; that over mass
    std::vector<std::uint8_t> marks_;                                  // by node
    Real least_need_ = 1;
    bool exact_ = false;  // step_ is the bound
};

/// Those that are implicit stay so, masses stay shared as they are, by shares or forms, and every other element that
/// does not stand what it is to becomes implicit: quick, but some would do with another share. Whether they add too
/// much to the moment is not asked.
ImplicitShare add_implicit_elements(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                                    std::span<const Real> mass, const ImplicitGoal& goal, std::span<Real> stiffness_sum,
                                    const ImplicitOutputs& out);

}  // namespace skerry
