#include "engine/output/page/stream/contact_stream.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "engine/output/page/stream/pack.h"

namespace skerry {
namespace {

auto key_of(const ContactSides& sides, const std::array<Index, 4>& node) {
    return std::tuple(sides, node);
}

/// Returns the lattice on which the point of a contact is encoded, and the lattice coordinates of a reference point:
/// the first vertex of the body to which the lattice belongs, or the origin if the contact has no body.
std::pair<Lattice, Code3> reference_of(const ContactSides& sides, const std::vector<BodyStream>& bodies) {
    const Index body = sides.first >= 0 ? sides.first : sides.second;
    if (body < 0) return {Lattice{}, Code3{}};
    const BodyStream& stream = bodies[static_cast<std::size_t>(body)];
    return {stream.lattice(), stream.first_code()};
}

}  // namespace

void ContactStream::sort_rows() {
    order_prev_.resize(rows_prev_.size());
    std::iota(order_prev_.begin(), order_prev_.end(), 0);
    std::ranges::sort(order_prev_, [&](Index a, Index b) {
        const Row &row_a = rows_prev_[static_cast<std::size_t>(a)], &row_b = rows_prev_[static_cast<std::size_t>(b)];
        return std::tuple(key_of(row_a.sides, row_a.node), a) < std::tuple(key_of(row_b.sides, row_b.node), b);
    });
}

Index ContactStream::find(const ContactSides& sides, const std::array<Index, 4>& node) const {
    const auto key = key_of(sides, node);
    const auto key_at = [&](Index row) {
        const Row& prev = rows_prev_[static_cast<std::size_t>(row)];
        return key_of(prev.sides, prev.node);
    };
    const auto found_row = std::ranges::lower_bound(order_prev_, key, {}, key_at);
    return found_row != order_prev_.end() && key_at(*found_row) == key ? *found_row : no_index;
}

void ContactStream::put_frame(const Frame& frame, std::span<const ContactSides> sides,
                              const std::vector<BodyStream>& bodies, const ValueScale& force, std::string& out) {
    const std::size_t count = frame.contacts.size();
    sort_rows();
    std::vector<Index> found(count);
    Index expected = 0;
    for (std::size_t i = 0; i < count; ++i) {
        found[i] = find(sides[i], frame.contacts[i].node);
        if (found[i] == no_index) {
            put_count(out, 0);
            continue;
        }
        put_count(out, 1 + zigzag(found[i] - expected));
        expected = found[i] + 1;
    }
    for (std::size_t i = 0; i < count; ++i)
        if (found[i] == no_index)
            for (const Index side : {sides[i].first, sides[i].second, sides[i].collider})
                put_count(out, static_cast<std::uint64_t>(side + 1));

    rows_.clear();
    std::vector<std::array<std::int64_t, number_count>> changes(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Contact& contact = frame.contacts[i];
        const auto [lattice, first_code] = reference_of(sides[i], bodies);
        std::array<std::int64_t, number_count> base{first_code[0], first_code[1], first_code[2]};
        if (found[i] != no_index) {
            base = rows_prev_[static_cast<std::size_t>(found[i])].code;
            for (std::size_t k = 3; k < number_count; ++k)
                base[k] = shifted(static_cast<int>(base[k]), exponent_prev_, force.exponent());
        } else if (i > 0 && sides[i - 1].first == sides[i].first && sides[i].first >= 0) {
            base = rows_.back().code;
        }
        const Code3 point = lattice.code(contact.point, {base[0], base[1], base[2]});
        const Vec3 f = contact.force();
        const Row row{sides[i],
                      contact.node,
                      {point[0], point[1], point[2], force.code(f.x()), force.code(f.y()), force.code(f.z()),
                       force.code(f.dot(contact.normal))}};
        for (std::size_t k = 0; k < number_count; ++k) changes[i][k] = row.code[k] - base[k];
        rows_.push_back(row);
    }
    for (std::size_t k = 0; k < number_count; ++k)
        for (std::size_t i = 0; i < count; ++i) put_change(out, changes[i][k]);

    Index region_prev = 0;
    for (const Contact& contact : frame.contacts) {
        put_change(out, contact.region - region_prev);
        region_prev = contact.region;
    }
    for (const Contact& contact : frame.contacts) put(out, static_cast<std::uint8_t>(contact.motion));
    rows_prev_.swap(rows_);
    exponent_prev_ = force.exponent();
}

}  // namespace skerry
