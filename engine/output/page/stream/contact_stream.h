// Encodes the contacts of the page, frame after frame, as changes.
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

/// Both sides of a contact, as body and collider numbers of the page; -1: none.
struct ContactSides {
    Index first = -1, second = -1, collider = -1;

    auto operator<=>(const ContactSides&) const = default;
};

/// Matches contacts with those of the previous frame by the touching nodes, and encodes the changes.
class ContactStream {
public:
    /// Writes per contact 0 if it is new, else 1 + zigzag(its row in the previous frame - expected row); the row after
    /// the last match is expected. Then per new contact: first, second, collider, each plus one. Then, component by
    /// component for all contacts, x, y, z of the point, x, y, z of the force and its normal part, each as a change.
    /// The reference is the contact in the previous frame. For a new contact it is the row above if that has the same
    /// first body, else zero (points: first vertex of the body). Points use the lattice of the first body, or else of
    /// the second, or else one of 1 um. Last, for all contacts the change of the region since the row above, then for
    /// all u8 state (0 open, 1 stick, 2 slide).
    void put_frame(const Frame& frame, std::span<const ContactSides> sides, const std::vector<BodyStream>& bodies,
                   const ValueScale& force, std::string& out);

private:
    static constexpr std::size_t number_count = 7;  // point, force, normal part

    struct Row {
        ContactSides sides;
        std::array<Index, 4> node;
        std::array<std::int64_t, number_count> code;
    };
    /// Sorts the rows of the previous frame by sides and nodes, into order_prev_.
    void sort_rows();
    Index find(const ContactSides& sides, const std::array<Index, 4>& node) const;

    std::vector<Row> rows_, rows_prev_;
    std::vector<Index> order_prev_;
    int exponent_prev_ = ValueScale::lowest;
};

}  // namespace skerry
