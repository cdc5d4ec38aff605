#include "systems/dynamics/motion/stillness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "systems/material/extract_rotation.h"

namespace skerry {

namespace {

namespace limits = own_sleep_limits;

/// Number of measurements of the drift (displacement of the nodes) that are due before `fraction` of one half of the
/// sleep time. With the fractional part frac, measurement i is due at the fraction (i + frac(i golden)) / measurements.
/// Equal intervals would make an oscillation of this period seem still.
int measurements_due(Real fraction) {
    constexpr Real golden = 0.6180339887498949;
    const int slot = static_cast<int>(fraction * limits::measurements);
    const Real threshold = slot * golden;
    return slot + (fraction * limits::measurements - slot >= threshold - std::floor(threshold));
}

Vec3 mean_of(std::span<const Vec3> points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& point : points) sum += point - points[0];  // avoids rounding errors far from the origin
    return points[0] + sum / static_cast<Real>(points.size());
}

/// Measures for how long one body has been still.
class Stillness {
public:
    Stillness(const RestInputs& bodies, const SleepSettings& settings, std::size_t body, const RestOutputs& state)
        : bodies_(bodies), settings_(settings), body_(body), state_(state) {}

    void update(Real h) const {
        Real& still_time = state_.still_time[body_];
        const Real edge = bodies_.mean_edge[body_];
        if (!(bodies_.max_speed[body_] < limits::speed * std::sqrt(settings_.gravity * edge))) {
            still_time = 0;
            return;
        }
        if (still_time == 0) {
            begin_half();
            state_.drift_before[body_] = state_.creep_before[body_] = 0;
        }
        const Real half_time = std::max(settings_.time / 2, h), before = still_time;
        still_time += h;
        const auto halves = [&](Real time) { return std::floor(time / half_time); };
        const auto part = [&](Real time) { return time / half_time - halves(time); };
        const bool ends = halves(still_time) > halves(before);
        if (!ends && measurements_due(part(still_time)) == measurements_due(part(before))) return;
        Real &drift = state_.drift[body_], &shape_drift = state_.shape_drift[body_];
        const Real now = drift_now(), shape_now = shape_distance(positions(), part_of_body(state_.still_position));
        const bool returns = drift < 0 || now < drift, shape_grows = shape_now >= shape_drift;
        const Real furthest = std::max(std::abs(drift), now);
        drift = returns ? -furthest : furthest;
        shape_drift = std::max(shape_drift, shape_now);
        if (furthest > limits::drift * edge) {
            still_time = 0;
        } else if (ends) {
            const Real least = std::max(state_.drift_before[body_], limits::noise * edge);
            const bool first = before < half_time;
            // A drift that grows with each measurement may be motion at constant speed, on ice or by a motor.
            const bool drift_grows = !returns && furthest > limits::noise * edge;
            if (!first && furthest > limits::growth * least)
                still_time = 0;
            else if (!first && (drift_grows || !is_balanced(half_time) || !keeps_shape(shape_grows)))
                still_time = half_time;  // this half now counts as the first, with which the next half is compared
            state_.drift_before[body_] = furthest;
            state_.creep_before[body_] = shape_grows ? shape_drift : 0;
            begin_half();
        }
    }

private:
    /// True if the mean forces on the nodes, over the last two halves of the sleep time, are in balance without
    /// damping, which does not act at rest (docs/methods/skipping.md 3.1, condition 4). The force that remains without
    /// damping on a mass m is m (a + c v) with the acceleration a, the velocity v and the damping rate c.
    bool is_balanced(Real half_time) const {
        // In a body with held nodes damping acts on the complete velocity, else only on the velocity relative to the
        // rigid motion.
        const bool held = bodies_.pinned_count[body_] > 0;
        const Real drift = std::abs(state_.drift[body_]), damped = held ? drift : state_.shape_drift[body_];
        // Bound on the mean acceleration, with triangular weights over both halves: |d2 - d1| / half_time^2, where d1
        // and d2 are the displacements of a node in the two halves.
        const Real acceleration = (drift + state_.drift_before[body_]) / (half_time * half_time);
        return acceleration + damping() * damped / half_time <= limits::imbalance * settings_.gravity;
    }

    /// True if the shape varies little about a constant shape and does not creep towards a distant shape
    /// (docs/methods/skipping.md 3.1, conditions 5 and 7). The remaining creep is estimated as that of a geometric
    /// series.
    bool keeps_shape(bool shape_grows) const {
        const Real now = state_.shape_drift[body_], before = state_.creep_before[body_];
        if (now <= limits::noise * bodies_.mean_edge[body_]) return true;
        const Real shape = shape_distance(positions(), part_of_body(bodies_.rest_position));
        if (now > std::max(limits::shape_change * shape, limits::shape_noise * bodies_.mean_edge[body_])) return false;
        const bool creeps = shape_grows && before > 0;
        // If the change of shape shrinks by q = now / before in each half, now q / (1 - q) remains.
        return !creeps || (now < before && now * now <= limits::creep * shape * (before - now));
    }

    Real damping() const {
        const Index material = bodies_.material[body_];
        return material == no_index ? 0 : bodies_.material_damping[static_cast<std::size_t>(material)];
    }

    template <class T>
    std::span<T> part_of_body(std::span<T> column) const {
        const Range nodes = bodies_.measured_nodes(body_);
        return column.subspan(static_cast<std::size_t>(nodes.begin), static_cast<std::size_t>(nodes.size()));
    }
    std::span<const Vec3> positions() const { return part_of_body(bodies_.position); }

    void begin_half() const {
        state_.drift[body_] = state_.shape_drift[body_] = 0;
        std::ranges::copy(positions(), part_of_body(state_.still_position).begin());
    }
    Real drift_now() const {
        Real squared = 0;
        const Range nodes = bodies_.measured_nodes(body_);
        for (Index n = nodes.begin; n < nodes.end; ++n)
            squared = std::max(squared, (bodies_.position[n] - state_.still_position[n]).squaredNorm());
        return std::sqrt(squared);
    }

    const RestInputs& bodies_;
    const SleepSettings& settings_;
    std::size_t body_;
    const RestOutputs& state_;
};

}  // namespace

Real shape_distance(std::span<const Vec3> points, std::span<const Vec3> others) {
    if (points.size() < 2) return 0;
    const Vec3 center = mean_of(points), other_center = mean_of(others);
    Mat3 covariance = Mat3::Zero();
    for (std::size_t n = 0; n < points.size(); ++n)
        covariance += (points[n] - center) * (others[n] - other_center).transpose();
    const std::array<Real, 4> turn = nearest_rotation(covariance, {1, 0, 0, 0});
    const Mat3 rotation = Eigen::Quaternion<Real>(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix();
    Real squared = 0;
    for (std::size_t n = 0; n < points.size(); ++n)
        squared = std::max(squared, (points[n] - center - rotation * (others[n] - other_center)).squaredNorm());
    return std::sqrt(squared);
}

void watch_stillness(const RestInputs& bodies, const SleepSettings& settings, std::size_t body, Real h,
                     const RestOutputs& state) {
    Stillness(bodies, settings, body, state).update(h);
}

}  // namespace skerry
