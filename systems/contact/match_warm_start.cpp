#include "systems/contact/match_warm_start.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {
namespace {

constexpr std::size_t contact_block = 512;  // ~5 us of merging

/// Turns an impulse by the smallest rotation that takes one unit normal to the other, so that it keeps its place in the
/// friction cone. A normal that flipped names another contact: nothing is carried over.
Vec3 turn(const Vec3& impulse, const Vec3& from, const Vec3& to) {
    const Real cosine = from.dot(to);
    constexpr Real flipped = -0.999;  // cosine; beyond it the axis of the rotation is noise
    if (!(cosine > flipped)) return Vec3::Zero();
    const Vec3 axis = from.cross(to);  // length sin(angle)
    return cosine * impulse + axis.cross(impulse) + (axis.dot(impulse) / (1 + cosine)) * axis;
}

/// Runs along the keys of a table, all of which ascend.
class SearchPlace {
public:
    SearchPlace(std::span<const ContactKey> keys, const ContactKey& first)
        : keys_(keys), row_(static_cast<std::size_t>(std::ranges::lower_bound(keys, first) - keys.begin())) {}

    /// Whether there is such a row, and then it is row().
    bool find(const ContactKey& key) {
        while (row_ < keys_.size() && keys_[row_] < key) ++row_;
        return row_ < keys_.size() && keys_[row_] == key;
    }
    std::size_t row() const { return row_; }

private:
    std::span<const ContactKey> keys_;
    std::size_t row_;
};

}  // namespace

bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, const RestingContactTable& resting, Real h, std::span<Vec3> impulse) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size());
    if (key.empty() || (last.key.empty() && resting.empty())) {
        std::fill(impulse.begin(), impulse.end(), Vec3::Zero());
        return false;
    }
    SKERRY_CHECK(last.key.empty() || (last.step.size() == 1 && last.step[0] > 0));
    const Real scale = last.key.empty() ? 0 : h / last.step[0];
    parallel_for(executor, key.size(), contact_block, [&](std::size_t begin, std::size_t end) {
        // every block finds its own place in both tables, then all run along together
        SearchPlace of_last(last.key, key[begin]), of_resting(resting.contact.key, key[begin]);
        for (std::size_t i = begin; i < end; ++i) {
            impulse[i] = Vec3::Zero();
            if (of_last.find(key[i])) {
                const std::size_t old = of_last.row();
                impulse[i] = scale * turn(last.impulse[old], last.normal[old], normal[i]);
            } else if (of_resting.find(key[i])) {
                const std::size_t old = of_resting.row();
                impulse[i] =
                    h / resting.step[old] * turn(resting.contact.impulse[old], resting.contact.normal[old], normal[i]);
            }
        }
    });
    return true;
}

void store_warm_start(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse,
                      Real h, WarmStartTable& last) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size());
    last.key.resize(key.size());
    last.normal.resize(key.size());
    last.impulse.resize(key.size());
    std::copy(key.begin(), key.end(), last.key.begin());
    std::copy(normal.begin(), normal.end(), last.normal.begin());
    std::copy(impulse.begin(), impulse.end(), last.impulse.begin());
    last.step.assign(key.empty() ? 0 : 1, h);
}

}  // namespace skerry
