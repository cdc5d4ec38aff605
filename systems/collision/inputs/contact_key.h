// Keys that identify pairs and features across steps (see ContactKey).
#pragma once

#include <cstdint>

#include "components/contact_table.h"

namespace skerry {

inline constexpr std::uint64_t edge_edge_bit = std::uint64_t{1} << 63;
inline constexpr std::uint64_t second_side_bit = std::uint64_t{1} << 62;
inline constexpr int local_bits = 31;
inline constexpr std::uint64_t local_mask = (std::uint64_t{1} << local_bits) - 1;

/// Key of a pair of two bodies. `first_slot`: the lower one of their handle slots; the caller must order them. For a
/// body paired with itself, both slots are equal.
inline std::uint64_t body_pair_key(std::uint32_t first_slot, std::uint32_t second_slot) {
    return std::uint64_t{first_slot} << local_bits | second_slot;
}

/// Key of a pair of a body and a collider, analytic or mesh. Bit 62 distinguishes it from body_pair_key.
inline std::uint64_t collider_pair_key(std::uint32_t body_slot, std::uint32_t collider_slot) {
    return std::uint64_t{1} << 62 | std::uint64_t{body_slot} << local_bits | collider_slot;
}

/// The two handle slots that a pair key contains. `first` is the slot of a body, `second` the slot of a body or
/// collider.
struct PairSlots {
    std::uint32_t first, second;
    bool is_collider;
};
inline PairSlots slots_of_pair(std::uint64_t key) {
    constexpr std::uint64_t collider_bit = std::uint64_t{1} << 62;
    return {static_cast<std::uint32_t>((key & ~collider_bit) >> local_bits),
            static_cast<std::uint32_t>(key & local_mask), (key & collider_bit) != 0};
}

/// Feature key of a point and a triangle. Both are numbered within their bodies. `point_of_second`: true if the point
/// belongs to the second body.
inline std::uint64_t point_triangle_feature(bool point_of_second, Index point, Index triangle) {
    return (point_of_second ? second_side_bit : 0) | static_cast<std::uint64_t>(point) << local_bits |
           static_cast<std::uint64_t>(triangle);
}

inline std::uint64_t edge_edge_feature(Index first, Index second) {
    return edge_edge_bit | static_cast<std::uint64_t>(first) << local_bits | static_cast<std::uint64_t>(second);
}

/// Feature key of a point of a body and a part of a collider (see collider_part_count).
inline std::uint64_t point_collider_feature(Index point, Index part) {
    return static_cast<std::uint64_t>(point) << local_bits | static_cast<std::uint64_t>(part);
}

/// Feature key of point k of a collider (see collider_point) and a triangle of a body. The number of the point comes
/// before the number of the triangle, as in point_triangle_feature.
inline std::uint64_t face_collider_feature(Index k, Index triangle) {
    return second_side_bit | static_cast<std::uint64_t>(k) << local_bits | static_cast<std::uint64_t>(triangle);
}

/// Contacts of one edge with one part of a collider are numbered from 0 to contacts_of_edge - 1; the feature key
/// contains contacts_of_edge * part + number. The last number is for a crossing, which can exist in addition to the
/// contacts of edge_contact().
inline constexpr Index contacts_of_edge = 9, crossing_of_edge = contacts_of_edge - 1;

inline std::uint64_t edge_collider_feature(Index edge, Index part) {
    return edge_edge_bit | static_cast<std::uint64_t>(edge) << local_bits |
           static_cast<std::uint64_t>(contacts_of_edge * part);
}

/// True for a key of two edges, and also for a key of an edge and a collider.
inline bool is_edge_edge(std::uint64_t feature) {
    return (feature & edge_edge_bit) != 0;
}
inline bool is_face_collider(std::uint64_t feature) {
    return (feature & (edge_edge_bit | second_side_bit)) == second_side_bit;
}
inline bool is_point_of_second(std::uint64_t feature) {
    return (feature & second_side_bit) != 0;
}
inline Index first_local(std::uint64_t feature) {
    return static_cast<Index>(feature >> local_bits & local_mask);
}
inline Index second_local(std::uint64_t feature) {
    return static_cast<Index>(feature & local_mask);
}

/// Upper part of the feature key of a point and a triangle, which identifies the point: all keys of one point with
/// different triangles have the same upper part.
inline std::uint64_t point_of_feature(std::uint64_t feature) {
    return feature >> local_bits;
}

}  // namespace skerry
