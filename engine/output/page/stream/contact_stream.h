// Encodes the contacts of each frame as changes from the previous frame.
#pragma once

#include <compare>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/stream/body_stream.h"
#include "engine/output/page/stream/value_scale.h"

namespace skerry {

/// The partners of a contact: numbers of bodies and of a collider on the page. The number -1 means that the contact has
/// no such partner.
struct ContactSides {
    Index first = -1, second = -1, collider = -1;

    auto operator<=>(const ContactSides&) const = default;
};

/// Encoder of contacts. A contact continues a contact of the previous frame if both have the same partners and nodes.
/// Its numbers are then written as changes from their values in the previous frame.
class ContactStream {
public:
    /// Writes, in this order:
    ///   1. for each contact: 0 if it is new, otherwise 1 + zigzag(its index in the previous frame - expected index),
    ///      where the expected index is one more than the index of the last match, and 0 before the first match;
    ///   2. for each new contact: first, second and collider, each plus one;
    ///   3. component by component, for all contacts: x, y, z of the point, x, y, z of the force, and the normal force,
    ///      each as change from a reference. The reference of a contact that continues is its value in the previous
    ///      frame. The reference of a new contact is the value of the preceding contact of this frame, if both have the
    ///      same first body; otherwise it is zero for forces, and the first vertex of the body for points;
    ///   4. for all contacts: the change of the region number from the preceding contact;
    ///   5. for all contacts: the state as u8 (0 open, 1 stick, 2 slide).
    /// Points are encoded on the lattice of the first body. If the contact has no first body, the lattice of the second
    /// body is used, and without any body a lattice at the origin with steps of 1 um.
    void put_frame(const Frame& frame, std::span<const ContactSides> sides, const std::vector<BodyStream>& bodies,
                   const ValueScale& force, std::string& out);

private:
    // numbers that are encoded for a contact: 3 for the point, 3 for the force, 1 for the normal force
    static constexpr std::size_t number_count = 7;

    struct Row {
        ContactSides sides;
        std::array<Index, 4> node;
        std::array<std::int64_t, number_count> code;
    };
    /// Stores the indices of the contacts of the previous frame in order_prev_, sorted by partners and nodes, so that
    /// find() can use a binary search. Contacts with equal partners and nodes keep their order.
    void sort_rows();
    Index find(const ContactSides& sides, const std::array<Index, 4>& node) const;

    std::vector<Row> rows_, rows_prev_;
    std::vector<Index> order_prev_;
    int exponent_prev_ = ValueScale::lowest;
};

}  // namespace skerry
