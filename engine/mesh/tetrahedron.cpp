#include "engine/mesh/tetrahedron.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/base/complaint.h"

namespace skerry::mesh {
namespace {

// Upper limit of the ratio |six_volumes| / (longest edge)^3 up to which a tetrahedron counts as flat. A regular
// tetrahedron has the ratio 0.71.
constexpr Real flat_ratio = 1e-12;

std::array<Vec3, 4> corners(const Mesh& mesh, const std::array<Index, 4>& t) {
    std::array<Vec3, 4> x;
    for (std::size_t a = 0; a < 4; ++a) x[a] = mesh.nodes[static_cast<std::size_t>(t[a])];
    return x;
}

Real six_volumes(const std::array<Vec3, 4>& x) {
    const Vec3 a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
    return a.dot(b.cross(c));
}

}  // namespace

Real six_volumes(const Mesh& mesh, const std::array<Index, 4>& tetrahedron) {
    return six_volumes(corners(mesh, tetrahedron));
}

std::array<Real, 6> edge_lengths(const Mesh& mesh, const std::array<Index, 4>& tetrahedron) {
    const std::array<Vec3, 4> x = corners(mesh, tetrahedron);
    return {(x[1] - x[0]).norm(), (x[2] - x[0]).norm(), (x[3] - x[0]).norm(),
            (x[2] - x[1]).norm(), (x[3] - x[1]).norm(), (x[3] - x[2]).norm()};
}

Real largest_face_squared(const Mesh& mesh, const std::array<Index, 4>& tetrahedron) {
    const std::array<Vec3, 4> x = corners(mesh, tetrahedron);
    Real largest = 0;
    for (std::size_t skip = 0; skip < 4; ++skip) {
        const Vec3& p = x[(skip + 1) % 4];
        const Vec3 u = x[(skip + 2) % 4] - p, v = x[(skip + 3) % 4] - p;
        largest = std::max(largest, u.cross(v).squaredNorm());
    }
    return largest;
}

Orientation orientation(const Mesh& mesh, const std::array<Index, 4>& tetrahedron) {
    const Real volume = six_volumes(mesh, tetrahedron);
    const std::array<Real, 6> edges = edge_lengths(mesh, tetrahedron);
    const Real longest = *std::max_element(edges.begin(), edges.end());
    // The negated comparison makes a tetrahedron flat also if the product underflows to zero or a value is NaN.
    if (!(std::abs(volume) > flat_ratio * longest * longest * longest)) return Orientation::flat;
    return volume > 0 ? Orientation::positive : Orientation::inverted;
}

void require_valid(const Mesh& mesh, const std::string& name) {
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (!mesh.nodes[n].allFinite())
            refuse_in(name, "node " + std::to_string(n), "position", "a coordinate that is not finite",
                      "finite coordinates (m)");
    const auto node_count = static_cast<Index>(std::min<std::size_t>(mesh.nodes.size(), 0x7fffffff));
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const std::array<Index, 4>& t = mesh.tetrahedra[e];
        for (std::size_t a = 0; a < 4; ++a) {
            if (t[a] < 0 || t[a] >= node_count)
                refuse_in(name, "tetrahedron " + std::to_string(e), "node", std::to_string(t[a]),
                          "a node index from 0 to " + std::to_string(node_count - 1));
            if (std::find(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(a), t[a]) !=
                t.begin() + static_cast<std::ptrdiff_t>(a))
                refuse_in(name, "tetrahedron " + std::to_string(e), "node", std::to_string(t[a]) + " twice",
                          "four different nodes");
        }
    }
}

}  // namespace skerry::mesh
