#include "engine/world/start/start_messages.h"

#include <cmath>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

/// Returns a vector as text. Components that are not larger than the rounding error of the largest component are
/// written as 0.
std::string text(Vec3 value) {
    constexpr Real rounding = 1e-9;
    const Real largest = value.cwiseAbs().maxCoeff();
    for (Real& component : value) component = std::abs(component) > rounding * largest ? component : 0;
    return short_text(value);
}

}  // namespace

std::string StartOverlap::message() const {
    const bool bodies = collider == ColliderHandle{};
    const std::string first_text = "body '" + first_name + "'",
                      second_text = (bodies ? "body '" : "collider '") + second_name + "'",
                      both = bodies ? "bodies '" + first_name + "' and '" + second_name + "'"
                                    : first_text + " and " + second_text,
                      place_text = " at " + text(place) + " m";
    switch (kind) {
        case OverlapKind::crossing:
            return both + " overlap by " + short_text(depth) + " m" + place_text;
        case OverlapKind::inside:
            return first_text + " is inside " + second_text + place_text + ", " + short_text(depth) + " m deep";
        case OverlapKind::around:
            return second_text + " is inside " + first_text + place_text + ", " + short_text(depth) + " m deep";
        case OverlapKind::coincident:
            return both + " coincide" + place_text;
    }
    return {};
}

void refuse_overlap(const StartOverlap& overlap, std::size_t other_count, const std::string& reason) {
    const bool second_leaves = overlap.kind == OverlapKind::around;
    const Vec3 direction = second_leaves ? Vec3(-overlap.direction) : overlap.direction;
    const std::string more_text = other_count == 0   ? ""
                                  : other_count == 1 ? ", and 1 more overlap"
                                                     : ", and " + std::to_string(other_count) + " more overlaps";
    refuse("start_overlaps", {}, "an overlap: " + overlap.message() + more_text,
           "bodies that are apart from each other and from colliders",
           reason + "; to remove this overlap, move '" + (second_leaves ? overlap.second_name : overlap.first_name) +
               "' by " + short_text(overlap.depth) + " m along " + text(direction) +
               ", or set start_overlaps to \"ignore\" to start with the overlap");
}

}  // namespace skerry
