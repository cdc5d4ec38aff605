#include "components/key_lists.h"

#include <algorithm>

namespace skerry {

namespace {

/// The keys after the time `t` and before the time `t + h`.
std::span<const TimeKey> keys_inside(std::span<const TimeKey> keys, Real t, Real h) {
    const auto begin = std::ranges::upper_bound(keys, t, {}, &TimeKey::time);
    return {begin, std::ranges::lower_bound(begin, keys.end(), t + h, {}, &TimeKey::time)};
}

}  // namespace

Real value_at(std::span<const TimeKey> keys, Real t) {
    const auto after = std::ranges::upper_bound(keys, t, {}, &TimeKey::time);
    if (after == keys.begin()) return keys.front().value;
    if (after == keys.end()) return keys.back().value;
    const TimeKey &a = *(after - 1), &b = *after;
    return a.value + (t - a.time) / (b.time - a.time) * (b.value - a.value);
}

Real mean_value(std::span<const TimeKey> keys, Real t, Real h) {
    const std::span<const TimeKey> inside = keys_inside(keys, t, h);
    if (inside.empty()) return (value_at(keys, t) + value_at(keys, t + h)) / 2;
    Real sum = 0;
    TimeKey last{t, value_at(keys, t)};
    for (const TimeKey& k : inside) {
        sum += (k.time - last.time) * (last.value + k.value) / 2;
        last = k;
    }
    return (sum + (t + h - last.time) * (last.value + value_at(keys, t + h)) / 2) / h;
}

bool changes(std::span<const TimeKey> keys, Real t, Real h) {
    const Real start = value_at(keys, t);
    return value_at(keys, t + h) != start ||
           std::ranges::any_of(keys_inside(keys, t, h), [&](const TimeKey& k) { return k.value != start; });
}

void set_keys(Column<Range>& range, Column<TimeKey>& key, std::size_t row, std::span<const TimeKey> keys) {
    erase_keys(range, key, row);
    if (keys.empty()) return;
    const auto begin = static_cast<Index>(key.size());
    for (const TimeKey& k : keys) key.push_back(k);
    range[row] = {begin, static_cast<Index>(key.size())};
}

}  // namespace skerry
