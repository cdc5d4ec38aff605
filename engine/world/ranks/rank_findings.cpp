#include "engine/world/ranks/rank_findings.h"

#include <algorithm>

#include "engine/world/step/step.h"

namespace skerry {

void combine(RankFindings& into, const RankFindings& from) {
    if (from.fault_body < into.fault_body) {
        into.fault = from.fault;
        into.fault_body = from.fault_body;
        into.fault_node = from.fault_node;
        into.fault_tetrahedron = from.fault_tetrahedron;
        into.fault_value = from.fault_value;
    }
    if (from.strain_rate > into.strain_rate ||
        (from.strain_rate == into.strain_rate && from.strained_body < into.strained_body)) {
        into.strain_rate = from.strain_rate;
        into.strained_body = from.strained_body;
    }
    into.unsolved_body = std::min(into.unsolved_body, from.unsolved_body);
    into.crossings += from.crossings;
    into.inversions += from.inversions;
    if (from.inverted_body < into.inverted_body) {
        into.inverted_body = from.inverted_body;
        into.inverted_tetrahedron = from.inverted_tetrahedron;
    }
    into.inverts_first |= from.inverts_first;
    into.beyond_lists |= from.beyond_lists;
    into.labels_open |= from.labels_open;
    into.label_rounds = std::max(into.label_rounds, from.label_rounds);
    into.pushed |= from.pushed;
    into.bodies_missing |= from.bodies_missing;
    into.ghosts_expired |= from.ghosts_expired;
    into.stop |= from.stop;
    into.wakes |= from.wakes;
    into.may_rest |= from.may_rest;
    into.moves |= from.moves;
    into.far |= from.far;
    add_counters(from.counters, into.counters);
}

}  // namespace skerry
