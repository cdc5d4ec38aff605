#include "systems/contact/match_warm_start.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {
namespace {

constexpr std::size_t contact_block = 2048;  // ~20 us of merging

/// Turns an impulse by the smallest rotation that takes one unit normal to the other, so that it keeps its place in the friction cone.
/// A normal that flipped names another contact: nothing is carried over.
Vec3 turn(const Vec3& impulse, const Vec3& from, const Vec3& to) {
    const Real cosine = from.dot(to);
    constexpr Real flipped = -0.999;  // cosine; beyond it the axis of the rotation is noise
    if (!(cosine > flipped)) return Vec3::Zero();
    const Vec3 axis = from.cross(to);  // length sin(angle)
    return cosine * impulse + axis.cross(impulse) + (axis.dot(impulse) / (1 + cosine)) * axis;
}

}  // namespace

bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal, const WarmStartTable& last, Real h,
                      std::span<Vec3> impulse) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size());
    if (key.empty() || last.key.empty()) {
        std::fill(impulse.begin(), impulse.end(), Vec3::Zero());
        return false;
    }
    SKERRY_CHECK(last.step.size() == 1 && last.step[0] > 0);
    const Real scale = h / last.step[0];
    const std::span<const ContactKey> last_key = last.key;
    parallel_for(executor, key.size(), contact_block, [&](std::size_t begin, std::size_t end) {
        // every block finds its own place in last step's table, then both run along together
        std::size_t old = static_cast<std::size_t>(std::lower_bound(last_key.begin(), last_key.end(), key[begin]) - last_key.begin());
        for (std::size_t i = begin; i < end; ++i) {
            while (old < last_key.size() && last_key[old] < key[i]) ++old;
            const bool known = old < last_key.size() && last_key[old] == key[i];
            impulse[i] = known ? Vec3(scale * turn(last.impulse[old], last.normal[old], normal[i])) : Vec3(Vec3::Zero());
        }
    });
    return true;
}

void store_warm_start(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse, Real h,
                      WarmStartTable& last) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size());
    last.key.resize(key.size());
    last.normal.resize(key.size());
    last.impulse.resize(key.size());
    last.step.assign(1, h);
    std::copy(key.begin(), key.end(), last.key.begin());
    std::copy(normal.begin(), normal.end(), last.normal.begin());
    std::copy(impulse.begin(), impulse.end(), last.impulse.begin());
}

}  // namespace skerry
