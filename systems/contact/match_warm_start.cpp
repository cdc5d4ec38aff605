#include "systems/contact/match_warm_start.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "components/check.h"
#include "jobs/parallel_for.h"

namespace skerry {
namespace {

constexpr std::size_t contact_block = 2048;  // ~20 us of merging

/// Turns an impulse by the smallest rotation that takes one unit normal to the other, so that it keeps its place in the
/// friction cone. A normal that flipped names another contact: nothing is carried over.
Vec3 turn(const Vec3& impulse, const Vec3& from, const Vec3& to) {
    const Real cosine = from.dot(to);
    constexpr Real flipped = -0.999;  // cosine; beyond it the axis of the rotation is noise
    if (!(cosine > flipped)) return Vec3::Zero();
    const Vec3 axis = from.cross(to);  // length sin(angle)
    return cosine * impulse + axis.cross(impulse) + (axis.dot(impulse) / (1 + cosine)) * axis;
}

/// Merges this step's impulses with those of idle pairs, which stand for a step of length `h` from now on. Both are
/// in key order, and no pair is in both.
void keep_resting(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse,
                  const IdlePairs& pairs, Real h, const WarmStartTable& last, WarmStartTable& next) {
    next.key.clear();
    next.normal.clear();
    next.impulse.clear();
    const Real scale = h / last.step[0];
    std::size_t p = 0, i = 0;
    const auto take_new = [&](std::size_t end) {
        for (; i < end; ++i) {
            next.key.push_back(key[i]);
            next.normal.push_back(normal[i]);
            next.impulse.push_back(impulse[i]);
        }
    };
    for (std::size_t old = 0; old < last.key.size(); ++old) {
        const std::uint64_t pair = last.key[old].pair;
        while (p < pairs.key.size() && pairs.key[p] < pair) ++p;
        if (p == pairs.key.size()) break;
        if (pairs.key[p] != pair || !pairs.idle[p]) continue;
        take_new(static_cast<std::size_t>(
            std::lower_bound(key.begin() + static_cast<std::ptrdiff_t>(i), key.end(), ContactKey{pair, 0}) -
            key.begin()));
        next.key.push_back(last.key[old]);
        next.normal.push_back(last.normal[old]);
        next.impulse.push_back(scale * last.impulse[old]);
    }
    take_new(key.size());
}

}  // namespace

bool match_warm_start(Executor& executor, std::span<const ContactKey> key, std::span<const Vec3> normal,
                      const WarmStartTable& last, Real h, std::span<Vec3> impulse) {
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
        std::size_t old =
            static_cast<std::size_t>(std::lower_bound(last_key.begin(), last_key.end(), key[begin]) - last_key.begin());
        for (std::size_t i = begin; i < end; ++i) {
            while (old < last_key.size() && last_key[old] < key[i]) ++old;
            const bool known = old < last_key.size() && last_key[old] == key[i];
            impulse[i] =
                known ? Vec3(scale * turn(last.impulse[old], last.normal[old], normal[i])) : Vec3(Vec3::Zero());
        }
    });
    return true;
}

void store_warm_start(std::span<const ContactKey> key, std::span<const Vec3> normal, std::span<const Vec3> impulse,
                      const IdlePairs& pairs, Real h, WarmStartTable& last, WarmStartTable& next) {
    SKERRY_CHECK(normal.size() == key.size() && impulse.size() == key.size() && pairs.idle.size() == pairs.key.size());
    const bool any_rests = std::ranges::find(pairs.idle, 1) != pairs.idle.end();
    if (any_rests && !last.key.empty()) {
        keep_resting(key, normal, impulse, pairs, h, last, next);
        std::swap(last.key, next.key);
        std::swap(last.normal, next.normal);
        std::swap(last.impulse, next.impulse);
    } else {
        last.key.resize(key.size());
        last.normal.resize(key.size());
        last.impulse.resize(key.size());
        std::copy(key.begin(), key.end(), last.key.begin());
        std::copy(normal.begin(), normal.end(), last.normal.begin());
        std::copy(impulse.begin(), impulse.end(), last.impulse.begin());
    }
    last.step.assign(1, h);
}

}  // namespace skerry
