#include "engine/study/flat_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "engine/output/number_text.h"

namespace skerry {

namespace {

// Cosine of the largest angle between neighbouring faces of one smooth surface, 40 degrees. The faces of a prism with 8
// sides meet at 45 degrees, so they count as intended edges.
constexpr Real least_cosine = 0.766;

/// Unit normal of each triangle; zero if it has no area.
std::vector<Vec3> normals_of(std::span<const Vec3> nodes, std::span<const std::array<Index, 3>> triangles) {
    std::vector<Vec3> normals;
    for (const auto& [a, b, c] : triangles) {
        const auto at = [&](Index node) { return nodes[static_cast<std::size_t>(node)]; };
        normals.push_back(Vec3((at(b) - at(a)).cross(at(c) - at(a))).normalized());
    }
    return normals;
}

/// Angle of a triangle at one of its nodes [rad].
Real angle_at(Index node, const std::array<Index, 3>& triangle, std::span<const Vec3> nodes) {
    const auto i = static_cast<std::size_t>(std::ranges::find(triangle, node) - triangle.begin());
    const auto side = [&](std::size_t to) {
        return Vec3(nodes[static_cast<std::size_t>(triangle[(i + to) % 3])] - nodes[static_cast<std::size_t>(node)]);
    };
    return std::atan2(side(1).cross(side(2)).norm(), side(1).dot(side(2)));
}

/// Normals at the corners of each triangle of the smooth surface that the triangles approximate. A corner normal is the
/// mean of the normals of the faces around the node, weighted by their angles there. Faces whose normals differ by 40
/// degrees or more from that of the triangle are left out.
std::vector<std::array<Vec3, 3>> corner_normals(std::span<const Vec3> nodes,
                                                std::span<const std::array<Index, 3>> triangles,
                                                std::span<const Vec3> normals) {
    std::vector<std::vector<std::size_t>> around(nodes.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const Index node : triangles[t]) around[static_cast<std::size_t>(node)].push_back(t);
    std::vector<std::array<Vec3, 3>> corners(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            Vec3 sum = Vec3::Zero();
            for (const std::size_t other : around[static_cast<std::size_t>(triangles[t][i])])
                if (normals[other].dot(normals[t]) > least_cosine)
                    sum += angle_at(triangles[t][i], triangles[other], nodes) * normals[other];
            corners[t][i] = sum.normalized();
        }
    return corners;
}

Real largest_angle(std::span<const std::array<Index, 3>> triangles, std::span<const Vec3> normals) {
    std::map<std::pair<Index, Index>, std::size_t> first;  // first triangle found at each edge
    Real least = 1;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto edge = std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]});
            const auto [known, is_new] = first.insert({edge, t});
            const Real cosine = is_new ? 1 : normals[known->second].dot(normals[t]);
            if (cosine > least_cosine) least = std::min(least, cosine);
        }
    return std::acos(least);
}

/// True if `name` is the name of a body that an entry of the scene file makes. `of_entry`: name of the entry. If the
/// entry makes several copies of its body, their names are `of_entry`_NUMBER.
bool is_name(const std::string& name, const BodyEntry& body, const std::string& of_entry) {
    if (!body.repeat && body.positions.empty()) return name == of_entry;
    return name.starts_with(of_entry + "_") &&
           name.find_first_not_of("0123456789", of_entry.size() + 1) == std::string::npos;
}

}  // namespace

Real FlatBody::error() const {
    // Ratio of the relative error of the displacements to that of the radius. It is 2 because the displacement of a
    // shell under pressure grows with the square of the radius, plus 1 because the pressure acts on the flat faces
    // instead of the curved surface.
    constexpr Real errors_of_radius = 3;
    return is_held ? errors_of_radius * faces.share : 0;
}

FlatFaces flat_faces(std::span<const Vec3> nodes, std::span<const std::array<Index, 3>> triangles) {
    constexpr Real least_angle = 0.01;  // a surface whose normal turns less along its edges counts as flat [rad]
    const std::vector<Vec3> normals = normals_of(nodes, triangles);
    const std::vector<std::array<Vec3, 3>> corners = corner_normals(nodes, triangles, normals);
    Real curved = 0, sum = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        // Distance of the triangle from the smooth surface: mean over the three edges. Along an edge of length L in a
        // surface of curvature k, the normal turns by the angle k L, and the middle of the edge lies k L^2/8 below the
        // surface. The largest k of the edges is that of the surface.
        Real offsets = 0, curvature = 0, most = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 edge = nodes[static_cast<std::size_t>(triangles[t][(i + 1) % 3])] -
                              nodes[static_cast<std::size_t>(triangles[t][i])];
            const Real length = edge.norm();
            if (length == 0) continue;
            const Real turn = std::abs((corners[t][(i + 1) % 3] - corners[t][i]).dot(edge)) / length;
            offsets += turn * length / 8 / 3;
            curvature = std::max(curvature, turn / length);
            most = std::max(most, turn);
        }
        if (most < least_angle) continue;
        const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(triangles[t][i])]; };
        const Real area = Vec3((at(1) - at(0)).cross(at(2) - at(0))).norm() / 2;
        curved += area;
        sum += area * offsets * curvature;
    }
    if (curved == 0) return {};
    return {sum / curved, largest_angle(triangles, normals)};
}

std::vector<FlatBody> flat_bodies(const SceneFile& file, const World& world) {
    std::vector<FlatBody> found;
    for (std::size_t b = 0; b < file.bodies.size(); ++b) {
        const BodyEntry& entry = file.bodies[b];
        if (!entry.mesh || !(entry.mesh->file || entry.mesh->surface)) continue;
        const std::string name = entry.name.empty() ? "body_" + std::to_string(b) : entry.name;
        const bool is_held = !entry.pin.items.empty() && std::ranges::all_of(entry.pin.items, [](const PinEntry& pin) {
            return pin.motion.keys.empty() && pin.motion.velocity.isZero() && pin.motion.angular_velocity.isZero();
        });
        FlatFaces faces;
        bool is_measured = false;
        for (const BodyHandle body : world.bodies()) {
            if (!is_name(world.name(body), entry, name) || world.dynamics(body) == BodyDynamics::rigid) continue;
            if (!is_measured) faces = flat_faces(world.positions(body), world.surface(body));
            is_measured = true;  // copies of a body have its shape
            if (faces.share > 0) found.push_back({world.name(body), faces, is_held});
        }
    }
    return found;
}

std::vector<std::string> flat_texts(std::span<const FlatBody> bodies) {
    constexpr Real degrees = 180 / std::numbers::pi;
    std::map<std::string, std::size_t> counts;                 // number of bodies with each remark
    std::vector<std::pair<std::string, std::string>> remarks;  // (first body with the remark, remark)
    for (const FlatBody& body : bodies) {
        const std::string text =
            ": refined meshes keep the flat faces of the file, which turn by up to " +
            short_text(body.faces.angle * degrees, 2) + " degrees and deviate from a smooth surface by " +
            percent(body.faces.share) + " of its radius. " +
            (body.is_held ? "The mesh errors of displacements and stresses contain three times that share of each value"
                          : "The error bars leave out this error of the shape") +
            ". A file with finer faces lowers it.";
        if (++counts[text] == 1) remarks.emplace_back(body.name, text);
    }
    std::vector<std::string> texts;
    for (const auto& [name, text] : remarks) {
        const std::size_t others = counts[text] - 1;
        texts.push_back("Body '" + name + "'" + (others > 0 ? " and " + std::to_string(others) + " more" : "") + text);
    }
    return texts;
}

}  // namespace skerry
