// Text and JSON about the tetrahedra that limit the stable step.
#pragma once

#include <iostream>
#include <string>

#include "engine/program/number_text.h"
#include "engine/program/start_text.h"
#include "engine/program/step_bound.h"

namespace skerry {

// A ratio of step lengths between 1 and this value counts as a small gain.
inline constexpr Real hardly_longer = 1.03;

inline Json bound_json(const StepBound& bound) {
    Json worst = Json::array(), without = Json::array();
    for (const CostlyTetrahedron& t : bound.worst)
        worst.push_back({{"tetrahedron", t.tetrahedron},
                         {"place", vector_json(t.place)},
                         {"altitude", t.altitude},
                         {"mean_edge", t.mean_edge},
                         {"dt", t.step}});
    for (const StepWithout& w : bound.without)
        without.push_back({{"share", w.share}, {"tetrahedra", w.count}, {"stable_dt", w.step}});
    return {{"stable_dt", bound.step}, {"element", name_of(bound.element)}, {"worst", worst}, {"without", without}};
}

/// Describes a ratio of stable steps: the step of the mesh without its worst tetrahedra, divided by the present step.
/// The ratio may be below 1, because removing tetrahedra reduces the mass of their nodes. This shortens the steps of
/// the neighbouring tetrahedra.
inline std::string compared(Real ratio) {
    if (ratio < 1 / hardly_longer) return short_number(ratio) + " times as long: shorter, because neighbours lose mass";
    if (ratio < 1) return "slightly shorter";
    return ratio < hardly_longer ? "slightly longer" : short_number(ratio) + " times as long";
}

/// Prints the tetrahedra that limit the stable step, and the stable step of the mesh without its worst tetrahedra.
inline void print_bound(const StepBound& bound, const char* indent) {
    for (const CostlyTetrahedron& t : bound.worst)
        std::cout << indent << "tetrahedron " << t.tetrahedron << " at (" << short_number(t.place.x()) << ", "
                  << short_number(t.place.y()) << ", " << short_number(t.place.z()) << ") m allows a step of "
                  << with_unit(t.step, "s") << ": smallest altitude " << with_unit(t.altitude, "m") << ", mean edge "
                  << with_unit(t.mean_edge, "m") << "\n";
    for (const StepWithout& w : bound.without)
        std::cout << indent << "without the worst " << (w.count == 1 ? "one" : grouped(w.count)) << " ("
                  << short_number(100 * w.share) << " % of the tetrahedra): a step of " << with_unit(w.step, "s")
                  << ", " << compared(w.step / bound.step) << "\n";
}

}  // namespace skerry
