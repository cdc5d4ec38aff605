#include "systems/contact/match_warm_start.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {
namespace {

// Contacts per task. Finding their impulses of the last step takes about 5 us.
constexpr std::size_t contact_block = 512;
// Contacts per task. Copying them takes about 5 us if other cores wrote them, because the data are then in the caches
// of these cores.
constexpr std::size_t stored_block = 512;

/// Rotates an impulse by the smallest rotation that takes the unit normal `from` to the unit normal `to`, so that the
/// impulse stays in the friction cone. If the normal has flipped, the impulse belonged to another contact, and the
/// result is zero.
Vec3 turn(const Vec3& impulse, const Vec3& from, const Vec3& to) {
    const Real cosine = from.dot(to);
    // Lower limit of the cosine of the rotation angle. Below it, rounding errors would determine the axis.
    constexpr Real flipped = -0.999;
    if (!(cosine > flipped)) return Vec3::Zero();
    const Vec3 axis = from.cross(to);  // length sin(angle)
    return cosine * impulse + axis.cross(impulse) + (axis.dot(impulse) / (1 + cosine)) * axis;
}

/// Cursor over the ascending keys of a table. The keys passed to find() must ascend, too.
class KeyCursor {
public:
    KeyCursor(std::span<const ContactKey> keys, const ContactKey& first)
        : keys_(keys), row_(static_cast<std::size_t>(std::ranges::lower_bound(keys, first) - keys.begin())) {}

    /// True if the table has a row with this key. In this case row() returns the row.
    bool find(const ContactKey& key) {
        while (row_ < keys_.size() && keys_[row_] < key) ++row_;
        return row_ < keys_.size() && keys_[row_] == key;
    }
    std::size_t row() const { return row_; }

private:
    std::span<const ContactKey> keys_;
    std::size_t row_;
};

/// Contacts of one pair of partners: rows begin .. end - 1.
struct Rows {
    std::size_t begin, end;
};

/// First row, from `row` on, at which the contacts of a new pair begin.
std::size_t start_of_pair(std::span<const ContactKey> key, std::size_t row) {
    while (row > 0 && row < key.size() && key[row].pair == key[row - 1].pair) ++row;
    return row;
}

Rows rows_of_pair(std::span<const ContactKey> key, std::uint64_t pair) {
    const auto begin = std::ranges::lower_bound(key, pair, {}, &ContactKey::pair),
               end = std::ranges::upper_bound(begin, key.end(), pair, {}, &ContactKey::pair);
    return {static_cast<std::size_t>(begin - key.begin()), static_cast<std::size_t>(end - key.begin())};
}

/// Largest distance over which a contact takes over the impulse of a vanished contact of its pair; 0 if no body of the
/// pair is rigid or implicit [m]. `row`: any contact of the pair in `now`.
Real reach_of_pair(const ContactsNow& now, std::size_t row) {
    const auto has_frame = [&](Index body) {
        return body != no_index && now.body_rigid[static_cast<std::size_t>(body)].size() > 0;
    };
    const Index first = now.first_body[row];
    constexpr Real distances = 2;
    return has_frame(first) || has_frame(now.second_body[row])
               ? distances * now.body_contact_distance[static_cast<std::size_t>(first)]
               : 0;
}

}  // namespace

bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, const RestingContactTable& resting, Real kick,
                      std::span<Vec3> impulse) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size());
    if (key.empty() || (last.key.empty() && resting.empty())) {
        std::fill(impulse.begin(), impulse.end(), Vec3::Zero());
        return false;
    }
    SKERRY_CHECK(last.key.empty() || (last.step.size() == 1 && last.step[0] > 0));
    const Real scale = last.key.empty() ? 0 : kick / last.step[0];
    parallel_for(executor, key.size(), contact_block, [&](std::size_t begin, std::size_t end) {
        // Each block searches once for its first key in the two tables of old impulses, `last` and `resting`. Then it
        // reads the contacts and these tables side by side in key order.
        KeyCursor last_cursor(last.key, key[begin]), resting_cursor(resting.contact.key, key[begin]);
        for (std::size_t i = begin; i < end; ++i) {
            impulse[i] = Vec3::Zero();
            if (last_cursor.find(key[i])) {
                const std::size_t old = last_cursor.row();
                impulse[i] = scale * turn(last.impulse[old], last.normal[old], normal[i]);
            } else if (resting_cursor.find(key[i])) {
                const std::size_t old = resting_cursor.row();
                impulse[i] = kick / resting.step[old] *
                             turn(resting.contact.impulse[old], resting.contact.normal[old], normal[i]);
            }
        }
    });
    return true;
}

bool hand_on_impulses(Executor& executor, const ContactsNow& now, const WarmStartTable& last, Real kick,
                      std::span<Vec3> impulse) {
    if (last.point.empty() || now.key.empty()) return false;
    SKERRY_CHECK(last.point.size() == last.key.size() && impulse.size() == now.key.size());
    // Lower limit of the cosine of the angle between the normals of the vanished contact and of the contact that takes
    // over its impulse.
    constexpr Real least_cosine = 0.9;
    const Real scale = kick / last.step[0];
    const auto pass_on = [&](std::size_t vanished, Rows rows, Real reach) {
        std::size_t nearest = rows.end;
        Real nearest_squared = reach * reach;
        for (std::size_t i = rows.begin; i < rows.end; ++i) {
            const Real distance_squared = (now.point[i] - last.point[vanished]).squaredNorm();
            if (!(distance_squared < nearest_squared) || !(now.normal[i].dot(last.normal[vanished]) > least_cosine))
                continue;
            nearest_squared = distance_squared;
            nearest = i;
        }
        if (nearest != rows.end)
            impulse[nearest] += scale * turn(last.impulse[vanished], last.normal[vanished], now.normal[nearest]);
    };
    // A block never splits a pair. An impulse only passes to a contact of the same pair, so no two blocks write the
    // same impulse.
    parallel_for(executor, last.key.size(), contact_block, [&](std::size_t begin, std::size_t end) {
        end = start_of_pair(last.key, end);
        for (std::size_t row = start_of_pair(last.key, begin); row < end;) {
            const std::uint64_t pair = last.key[row].pair;
            const Rows rows = rows_of_pair(now.key, pair);
            const Real reach = rows.begin < rows.end ? reach_of_pair(now, rows.begin) : 0;
            std::size_t now_row = rows.begin;
            for (; row < end && last.key[row].pair == pair; ++row) {
                while (now_row < rows.end && now.key[now_row] < last.key[row]) ++now_row;
                const bool persists = now_row < rows.end && now.key[now_row] == last.key[row];
                if (!persists && reach > 0 && last.impulse[row] != Vec3::Zero()) pass_on(row, rows, reach);
            }
        }
    });
    return true;
}

void store_warm_start(Executor& executor, const ContactsDone& done, Real kick, WarmStartTable& last) {
    const std::size_t count = done.key.size();
    SKERRY_CHECK(done.normal.size() == count && done.impulse.size() == count);
    SKERRY_CHECK(done.point.empty() || done.point.size() == count);
    last.key.resize(count);
    last.normal.resize(count);
    last.impulse.resize(count);
    last.point.resize(done.point.size());
    last.step.assign(count == 0 ? 0 : 1, kick);
    parallel_for(executor, count, stored_block, [&](std::size_t begin, std::size_t end) {
        const auto copy_rows = [&](const auto& from, auto& to) {
            std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin),
                      from.begin() + static_cast<std::ptrdiff_t>(end), to.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        copy_rows(done.key, last.key);
        copy_rows(done.normal, last.normal);
        copy_rows(done.impulse, last.impulse);
        if (!done.point.empty()) copy_rows(done.point, last.point);
    });
}

}  // namespace skerry
