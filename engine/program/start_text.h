// Text and JSON about bodies that overlap at the start of a run.
#pragma once

#include "engine/output/number_text.h"
#include "engine/scene/place.h"
#include "skerry/report.h"

namespace skerry {

inline Json vector_json(const Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

inline Json overlap_json(const StartOverlap& overlap) {
    return object_of({{"first", overlap.first_name},
                      {"second", overlap.second_name},
                      {"kind", name_of(overlap.kind)},
                      {"depth", overlap.depth},
                      {"place", vector_json(overlap.place)},
                      {"resolved", overlap.resolved}});
}

inline Json overlaps_json(const WorldReport& report) {
    Json overlaps = Json::array();
    for (const StartOverlap& overlap : report.start_overlaps) overlaps.push_back(overlap_json(overlap));
    return overlaps;
}

/// A warning is given if surfaces overlap by more than this fraction of the mean edge length, or if the distance of
/// surfaces is less than their contact distance by more than this fraction of the mean edge length.
inline constexpr Real visible_share = 0.05;

inline std::string into_shell_text(Real depth) {
    return "at the start, surfaces are up to " + with_unit(depth, "m") +
           " closer than their contact distance: move the bodies apart, or reduce contact_distance";
}

/// A warning is given if a collider rotates by more than this angle in a step [rad]. Contacts assume that points of its
/// surface move along straight lines within a step. For an angle a, the position error of such a point is a^2 / 2 times
/// its distance from the axis: 3 %.
inline constexpr Real visible_turn = 0.25;

inline std::string turning_text(const WorldReport& report) {
    return "collider \"" + report.turning_collider + "\" turns by " + short_text(report.collider_turn) +
           " rad in a step, but contacts assume that surfaces move along straight lines within a step: shorten the "
           "step (--step) " +
           "to " + percent(visible_turn / report.collider_turn) + " of the present length";
}

/// Describes how the overlaps were resolved, for example "3 overlaps, 4 bodies moved apart, the largest movement ball_2
/// by 1.5 mm". Returns an empty text if no body was moved.
inline std::string moves_text(const WorldReport& report) {
    const StartMove* furthest = nullptr;
    for (const StartMove& move : report.start_moves)
        if (furthest == nullptr || move.translation.norm() > furthest->translation.norm()) furthest = &move;
    if (furthest == nullptr) return {};
    const std::size_t overlaps = report.start_overlaps.size(), bodies = report.start_moves.size();
    return grouped(overlaps) + (overlaps == 1 ? " overlap, " : " overlaps, ") + grouped(bodies) +
           (bodies == 1 ? " body moved: " : " bodies moved apart, the largest movement ") + furthest->name + " by " +
           with_unit(furthest->translation.norm(), "m");
}

}  // namespace skerry
