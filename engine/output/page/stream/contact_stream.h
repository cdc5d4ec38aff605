// The contacts of the page, frame after frame, as changes.
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

/// What a contact touches, in numbers of the page; -1: none.
struct ContactSides {
    Index first = -1, second = -1, collider = -1;

    auto operator<=>(const ContactSides&) const = default;
};

/// Finds contacts of the frame before again by the nodes that touch, and says what has changed.
class ContactStream {
public:
    /// By contact: 0 if it is new, else one more than the zigzag of how far its row in the frame before is from that
    /// after the row of the last one found. Then for each new one first, second, collider, each plus one. Then by
    /// contact, each as its change since the frame before, of new ones since the row above if that has the same first
    /// body, else from zero (points: from the first vertex of that body): x, y, z of the point on the lattice of the
    /// first body, or else the second, or else one of 1 um; x, y, z of the force and its normal part, on the scale.
    /// Last by contact: change of the region since the row above; u8 state (0 open, 1 stick, 2 slide).
    void put_frame(const Frame& frame, std::span<const ContactSides> sides, const std::vector<BodyStream>& bodies,
                   const ValueScale& force, std::string& out);

private:
    static constexpr std::size_t number_count = 7;  // point, force, normal part

    struct Row {
        ContactSides sides;
        std::array<Index, 4> node;
        std::array<std::int64_t, number_count> code;
    };
    /// Rows of rows_ in the order of what touches.
    void sort_rows();
    Index find(const ContactSides& sides, const std::array<Index, 4>& node) const;

    std::vector<Row> rows_, rows_prev_;
    std::vector<Index> order_prev_;
    int exponent_prev_ = ValueScale::lowest;
};

}  // namespace skerry
