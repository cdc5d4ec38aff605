#include "profiling/work_precision/record.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace skerry::profiling {

Real distance_at(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t sample) {
    Real sum = 0, mass = 0;
    std::size_t n = 0;
    for (const PrecisionBody& body : scene.bodies)
        for (const Real m : body.mass) {
            sum += m * (a.positions[sample][n] - b.positions[sample][n]).squaredNorm();
            mass += m;
            ++n;
        }
    return std::sqrt(sum / mass) / scene.length;
}

Real mean_distance(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t samples) {
    if (std::min(a.positions.size(), b.positions.size()) < samples) return std::numeric_limits<Real>::infinity();
    Real sum = 0;
    for (std::size_t s = 0; s < samples; ++s) sum += distance_at(scene, a, b, s);
    return sum / static_cast<Real>(samples);
}

Probes::Probes(const PrecisionScene& scene, int points_per_body) {
    std::size_t first = 0;
    for (const PrecisionBody& body : scene.bodies) {
        const std::vector<Vec3>& x = body.mesh.nodes;
        Vec3 lower = x[0], upper = x[0];
        for (const Vec3& node : x) lower = lower.cwiseMin(node), upper = upper.cwiseMax(node);
        // Every mesh gets equal random numbers. Points lie in the core of the bounding box, where all meshes are
        // assumed to have material.
        std::mt19937 random(7);
        const auto next = [&] { return 0.25 + 0.5 * static_cast<Real>(random()) / 4294967295.0; };
        for (int p = 0; p < points_per_body; ++p) {
            const Vec3 share(next(), next(), next());
            const Vec3 point = lower + share.cwiseProduct(upper - lower);
            Place best{};
            Real best_inside = -std::numeric_limits<Real>::infinity();
            for (const auto& t : body.mesh.tetrahedra) {
                const auto at = [&](std::size_t k) -> const Vec3& { return x[static_cast<std::size_t>(t[k])]; };
                Mat3 edges;
                edges << at(1) - at(0), at(2) - at(0), at(3) - at(0);
                const Vec3 w = edges.inverse() * (point - at(0));
                const Real inside = std::min({w.x(), w.y(), w.z(), 1 - w.sum()});
                if (inside <= best_inside) continue;
                best_inside = inside;
                for (std::size_t k = 0; k < 4; ++k) best.node[k] = first + static_cast<std::size_t>(t[k]);
                best.weight = {1 - w.sum(), w.x(), w.y(), w.z()};
            }
            places_.push_back(best);
        }
        first += x.size();
    }
}

std::vector<std::vector<Vec3>> Probes::follow(const Record& record) const {
    std::vector<std::vector<Vec3>> paths;
    for (const std::vector<Vec3>& x : record.positions) {
        std::vector<Vec3> points;
        for (const Place& place : places_) {
            Vec3 point = Vec3::Zero();
            for (std::size_t k = 0; k < 4; ++k) point += place.weight[k] * x[place.node[k]];
            points.push_back(point);
        }
        paths.push_back(std::move(points));
    }
    return paths;
}

Real mean_distance(const std::vector<std::vector<Vec3>>& a, const std::vector<std::vector<Vec3>>& b, Real length) {
    if (a.size() != b.size()) return std::numeric_limits<Real>::infinity();
    Real sum = 0;
    for (std::size_t s = 0; s < a.size(); ++s) {
        Real square = 0;
        for (std::size_t p = 0; p < a[s].size(); ++p) square += (a[s][p] - b[s][p]).squaredNorm();
        sum += std::sqrt(square / static_cast<Real>(a[s].size()));
    }
    return sum / static_cast<Real>(a.size()) / length;
}

}  // namespace skerry::profiling
