// Findings of an attempt at a step that all ranks combine, so that all of them decide alike whether to commit the step.
#pragma once

#include <limits>

#include "components/types.h"
#include "skerry/report.h"
#include "systems/dynamics/checks/check_state.h"

namespace skerry {

/// Findings of this rank in an attempt at a step, or the combined findings of all ranks. They name bodies by their rows
/// in the undivided world, because rows of BodyTable differ between ranks.
///
/// In the combined findings, each crossing, element, contact and region counts once, although several ranks may hold
/// it. Sums of energy are left out, because their last digits would depend on the order of the ranks.
struct RankFindings {
    // Fault of the first faulty body, in the order of the undivided world. `fault_value`: StepVerdict::value, the size
    // of the fault.
    StepFault fault = StepFault::none;
    Index fault_body = nobody;
    Index fault_node = no_index;         // number of the node within the body
    Index fault_tetrahedron = no_index;  // number of the tetrahedron within the body
    Real fault_value = 0;
    // Largest deformation rate, and its body (StepVerdict::fastest).
    Real strain_rate = 0;  // [1/s]
    Index strained_body = nobody;
    Index unsolved_body = nobody;  // StrainFindings::unsolved
    Index crossings = 0;           // StepFindings::crossings
    // Number of inverted tetrahedra, and the first of them (Inversions). `inverts_first`: Inversions::is_first_of_body.
    Index inversions = 0;
    Index inverted_body = nobody;
    Index inverted_tetrahedron = no_index;  // number of the tetrahedron within the body
    bool inverts_first = false;
    bool beyond_lists = false;  // CrossingTable::beyond_lists
    // The next members are used only with several ranks. The attempt is repeated for labels_open, bodies_missing and
    // ghosts_expired.
    bool labels_open = false;     // labels of contact regions still changed in the last round (LabelRounds)
    int label_rounds = 0;         // number of rounds of labels that this attempt needed (LabelRounds)
    bool pushed = false;          // RegionTable::pushed
    bool bodies_missing = false;  // a rank does not hold all bodies of a region that it has to solve
    bool ghosts_expired = false;  // holders of bodies must be found again (watch_ghosts)
    bool stop = false;            // a callback of World::advance has asked to end the call
    bool wakes = false;           // a body that several ranks hold wakes in this step
    bool may_rest = false;        // a body that several ranks hold may fall asleep after this step
    // `moves` and `far` tell agree_to_start() whether the ranks must communicate before the next step.
    bool moves = false;    // a body is awake or has a speed
    bool far = false;      // a body may be too far from the origin (check_distance)
    RunCounters counters;  // contacts, regions and solver work of the attempt (count_step)

    // Placeholder for no body. It is greater than all row numbers, so that the minimum over ranks is a body if any rank
    // has found one.
    static constexpr Index nobody = std::numeric_limits<Index>::max();
    bool again_over_ranks() const { return labels_open || bodies_missing || ghosts_expired; }
};

/// Adds the findings of another rank. The result does not depend on the order in which ranks are added.
void combine(RankFindings& into, const RankFindings& from);

}  // namespace skerry
