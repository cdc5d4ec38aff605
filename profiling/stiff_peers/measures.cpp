#include "profiling/stiff_peers/measures.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "systems/collision/build_surface.h"

namespace skerry::profiling {
namespace {

using Places = std::vector<Vec3>;

Vec3 mean(const PrecisionScene& scene, const Places& values) {
    Vec3 sum = Vec3::Zero();
    Real mass = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
        sum += scene.bodies[0].mass[n] * values[n];
        mass += scene.bodies[0].mass[n];
    }
    return sum / mass;
}

void measure_incline(const PrecisionScene& scene, const Record& record, Measures& found) {
    const std::size_t half = record.positions.size() / 2 - 1, end = record.positions.size() - 1;
    const Real time = scene.seconds / 2;
    if (scene.name == "holds") {
        found.creep = (mean(scene, record.positions[end]) - mean(scene, record.positions[half])).norm() / time;
        return;
    }
    const Vec3& gravity = scene.gravity.front().gravity;
    const Real law = gravity.x() + scene.material.friction * gravity.z();
    const Real gained = (mean(scene, record.velocities[end]) - mean(scene, record.velocities[half])).x();
    found.acceleration_error = gained / time / law - 1;
}

/// Position and height of the vertex of the parabola through a maximum and its neighbours.
std::array<Real, 2> top_of(const std::vector<Real>& values, std::size_t k) {
    if (k == 0 || k + 1 >= values.size()) return {static_cast<Real>(k), values[k]};
    const Real slope = (values[k + 1] - values[k - 1]) / 2, bend = values[k + 1] - 2 * values[k] + values[k - 1];
    const Real shift = bend < 0 ? -slope / bend : 0;
    return {static_cast<Real>(k) + shift, values[k] + slope * shift + bend * shift * shift / 2};
}

std::size_t largest(const std::vector<Real>& values, std::size_t begin, std::size_t end) {
    const auto at = [&](std::size_t k) {
        return values.begin() + static_cast<std::ptrdiff_t>(std::min(k, values.size()));
    };
    return static_cast<std::size_t>(std::max_element(at(begin), at(end)) - values.begin());
}

/// Searches the first peak in the first 0.65 periods of beam theory, whose period is 62 samples. Searches the other
/// peaks one period after another.
void measure_cantilever(const PrecisionScene& scene, const Record& record, Measures& found) {
    const Places& nodes = scene.bodies[0].mesh.nodes;
    std::size_t tip = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if ((nodes[n] - Vec3(0.5, 0, 0)).norm() < 1e-9) tip = n;
    std::vector<Real> sag{0};
    for (const Places& places : record.positions) sag.push_back(-places[tip].z());
    const Real interval = scene.seconds / scene.samples;
    constexpr std::size_t beam = 62;
    const std::array<Real, 2> first = top_of(sag, largest(sag, 0, beam * 65 / 100));
    Real last = first[0], period = 2 * first[0];
    for (int k = 1; k < 4; ++k) {
        const auto about = static_cast<std::size_t>(last + period);
        const Real next = top_of(sag, largest(sag, about - beam / 4, about + beam / 4))[0];
        // The remainder of a strongly damped swing may have its peak anywhere.
        if (std::abs(next - last - period) > 0.1 * period) break;
        last = next;
        period = (last - first[0]) / k;
    }
    found.period = period * interval;
    found.peak = first[1];
    found.peak_time = first[0] * interval;
    const auto begin = sag.begin() + std::lround(4 * period), end = sag.begin() + std::lround(5 * period) + 1;
    const auto [low, high] = std::minmax_element(begin, std::min(end, sag.end()));
    found.left = (*high - *low) / found.peak;
}

/// Depth of a point in a body; 0 outside [m]. Distances are those to the planes of boundary faces. For a convex body
/// this is the distance to its surface.
class Inside {
public:
    Inside(const Mesh& mesh, std::span<const Vec3> places) : mesh_(mesh), places_(places) {
        box_.setEmpty();
        for (const Vec3& position : places) box_.extend(position);
        for (const auto& t : mesh.tetrahedra) {
            Mat3 edges;
            for (int k = 0; k < 3; ++k) edges.col(k) = at(t[static_cast<std::size_t>(k) + 1]) - at(t[0]);
            inverse_.push_back(edges.inverse());
        }
    }
    Real depth(const Vec3& point, std::span<const BoundaryTriangle> faces) const {
        if (!box_.contains(point) || !holds(point)) return 0;
        Real least = std::numeric_limits<Real>::infinity();
        for (const BoundaryTriangle& face : faces) {
            const Vec3 &a = at(face.node[0]), &b = at(face.node[1]), &c = at(face.node[2]);
            least = std::min(least, std::abs((b - a).cross(c - a).normalized().dot(point - a)));
        }
        return least;
    }
    const Eigen::AlignedBox<Real, 3>& box() const { return box_; }

private:
    const Vec3& at(Index n) const { return places_[static_cast<std::size_t>(n)]; }
    bool holds(const Vec3& point) const {
        for (std::size_t t = 0; t < inverse_.size(); ++t) {
            const Vec3 w = inverse_[t] * (point - at(mesh_.tetrahedra[t][0]));
            if (w.minCoeff() >= 0 && w.sum() <= 1) return true;
        }
        return false;
    }

    const Mesh& mesh_;
    std::span<const Vec3> places_;
    Eigen::AlignedBox<Real, 3> box_;
    std::vector<Mat3> inverse_;
};

/// Depth of the deepest node of one body in another [m].
Real overlap_of(const PrecisionScene& scene, const Places& places,
                const std::vector<std::vector<BoundaryTriangle>>& faces) {
    std::vector<std::span<const Vec3>> nodes;
    std::vector<Inside> inside;
    std::size_t first = 0;
    for (const PrecisionBody& body : scene.bodies) {
        nodes.emplace_back(&places[first], body.mesh.nodes.size());
        inside.emplace_back(body.mesh, nodes.back());
        first += nodes.back().size();
    }
    Real deepest = 0;
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b) {
            if (a == b || !inside[a].box().intersects(inside[b].box())) continue;
            const Real sphere = scene.bodies[a].sphere;
            for (const Vec3& point : nodes[b])
                deepest = std::max(
                    deepest, sphere > 0 ? sphere - (point - nodes[a][0]).norm() : inside[a].depth(point, faces[a]));
        }
    return deepest;
}

void measure_overlaps(const PrecisionScene& scene, const Record& record, Measures& found) {
    std::vector<std::vector<BoundaryTriangle>> faces;
    for (const PrecisionBody& body : scene.bodies) faces.push_back(boundary_triangles(body.mesh.tetrahedra));
    found.overlap = found.below_planes = 0;
    for (const Places& places : record.positions) {
        found.overlap_at_end = overlap_of(scene, places, faces);
        found.overlap = std::max(found.overlap, found.overlap_at_end);
        for (const PrecisionPlane& plane : scene.planes)
            for (const Vec3& position : places)
                found.below_planes = std::max(found.below_planes, -plane.normal.dot(position - plane.point));
    }
}

void measure_rest(const PrecisionScene& scene, const Record& record, Measures& found) {
    const auto last = static_cast<std::size_t>(std::lround(0.1 / (scene.seconds / scene.samples)));
    Real sum = 0;
    std::size_t count = 0;
    for (std::size_t s = record.velocities.size() - last; s < record.velocities.size(); ++s)
        for (const Vec3& v : record.velocities[s]) {
            sum += v.squaredNorm();
            ++count;
        }
    found.speed = std::sqrt(sum / static_cast<Real>(count));
}

/// Measures how deep the ball's lowest point comes below the initial top of the block.
void measure_ball(const PrecisionScene& scene, const Record& record, Measures& found) {
    const Places& block = scene.bodies[0].mesh.nodes;
    Real top = block[0].z();
    for (const Vec3& node : block) top = std::max(top, node.z());
    std::vector<Real> depth;
    for (const Places& places : record.positions)
        depth.push_back(top - (places[block.size()].z() - scene.bodies[1].sphere));
    const std::array<Real, 2> deepest = top_of(depth, largest(depth, 0, depth.size()));
    found.peak_time = (deepest[0] + 1) * scene.seconds / scene.samples;
    found.peak = deepest[1];
}

}  // namespace

Measures measure(const PrecisionScene& scene, const Record& record) {
    Measures found;
    if (!record.finished) return found;
    if (scene.name == "cantilever") {
        measure_cantilever(scene, record, found);
        return found;
    }
    measure_overlaps(scene, record, found);
    if (scene.name == "holds" || scene.name == "slides") measure_incline(scene, record, found);
    if (scene.name == "stack" || scene.name == "pile" || scene.name.starts_with("drop"))
        measure_rest(scene, record, found);
    if (scene.name == "ball on block") measure_ball(scene, record, found);
    return found;
}

}  // namespace skerry::profiling
