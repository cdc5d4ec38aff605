#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/mesh/shapes/add_tetrahedron.h"

namespace skerry::mesh {
namespace {

/// Builds a ball from an icosahedron. Its centre and its 20 faces form 20 nearly regular tetrahedra (sectors). With the
/// number n of shells, each sector is divided into n^3 tetrahedra, and the 10 s^2 + 2 nodes of shell s are moved onto a
/// sphere.
///
/// The mesh has six fivefold axes, and so no preferred grid direction.
class BallBuilder {
public:
    BallBuilder(Real radius, int shells) : radius_(radius), shells_(shells) {
        // The poles lie on the z axis, which is a fivefold axis. Therefore a ball rests on a node, and a rotation by 72
        // degrees about z leaves the mesh unchanged.
        const Real height = 1 / std::sqrt(Real{5}), wide = 2 * height, fifth = 2 * std::acos(Real{-1}) / 5;
        corner_[0] = Vec3(0, 0, -1);
        corner_[11] = Vec3(0, 0, 1);
        for (int i = 0; i < 5; ++i) {
            corner_[static_cast<std::size_t>(1 + i)] =
                Vec3(wide * std::cos(fifth * i), wide * std::sin(fifth * i), -height);
            corner_[static_cast<std::size_t>(6 + i)] =
                Vec3(wide * std::cos(fifth * (i + 0.5)), wide * std::sin(fifth * (i + 0.5)), height);
        }
        angle_ = std::atan(2.0);  // angle between neighbouring corners, as seen from the centre
    }

    Mesh build() {
        mesh_.nodes.push_back(Vec3::Zero());
        for (int i = 0; i < 5; ++i) {
            const int next = (i + 1) % 5;
            fill_sector({0, 1 + i, 1 + next});
            fill_sector({1 + i, 1 + next, 6 + i});
            fill_sector({1 + next, 6 + i, 6 + next});
            fill_sector({11, 6 + i, 6 + next});
        }
        return std::move(mesh_);
    }

private:
    // Barycentric coordinates of a node in its sector, times shells_: first for the three corners, then for the centre.
    using Steps = std::array<int, 4>;
    // Identifies a node by sorted pairs (corner of the icosahedron, coordinate). A corner with the coordinate 0 is
    // replaced by the pair (-1, 0). All sectors that share the node therefore compute the same key.
    using Key = std::array<std::pair<int, int>, 3>;

    Index node(const std::array<int, 3>& sector, const Steps& steps) {
        const int shell = steps[0] + steps[1] + steps[2];
        if (shell == 0) return 0;
        Key key{};
        for (std::size_t a = 0; a < 3; ++a) key[a] = steps[a] > 0 ? std::pair{sector[a], steps[a]} : std::pair{-1, 0};
        std::sort(key.begin(), key.end());
        const auto [place, added] = row_.try_emplace(key, static_cast<Index>(mesh_.nodes.size()));
        if (added) {
            // Spherical linear interpolation divides the arc of each edge of the sector evenly. Inside the sector the
            // spacing of the nodes is nearly even.
            Vec3 direction = Vec3::Zero();
            for (const auto& [corner, count] : key)
                if (count > 0)
                    direction += std::sin(angle_ * count / shell) * corner_[static_cast<std::size_t>(corner)];
            mesh_.nodes.push_back(radius_ * shell / shells_ * direction.normalized());
        }
        return place->second;
    }

    void fill_sector(const std::array<int, 3>& sector) {
        const auto at = [&](Steps base, std::initializer_list<std::size_t> moves) {
            for (const std::size_t m : moves) base[m] += 1;
            return node(sector, base);
        };
        for (int sum = std::max(0, shells_ - 3); sum < shells_; ++sum)
            for (int i = 0; i <= sum; ++i)
                for (int j = 0; i + j <= sum; ++j)
                    for (int k = 0; i + j + k <= sum; ++k) {
                        const Steps base{i, j, k, sum - i - j - k};
                        if (sum == shells_ - 1)
                            add_tetrahedron(mesh_, {at(base, {0}), at(base, {1}), at(base, {2}), at(base, {3})});
                        if (sum == shells_ - 2)
                            split_octahedron({at(base, {0, 1}), at(base, {2, 3}), at(base, {0, 2}), at(base, {1, 3}),
                                              at(base, {0, 3}), at(base, {1, 2})});
                        if (sum == shells_ - 3)
                            add_tetrahedron(mesh_, {at(base, {0, 1, 2}), at(base, {0, 1, 3}), at(base, {0, 2, 3}),
                                                    at(base, {1, 2, 3})});
                    }
    }

    /// Divides an octahedron into four tetrahedra around the shortest of its three diagonals, or the first of equally
    /// short ones. The ends of diagonal d are n[2 d] and n[2 d + 1].
    void split_octahedron(const std::array<Index, 6>& n) {
        std::size_t best = 0;
        Real shortest = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            const Real length =
                (mesh_.nodes[static_cast<std::size_t>(n[2 * d])] - mesh_.nodes[static_cast<std::size_t>(n[2 * d + 1])])
                    .norm();
            // Diagonals that should be equal by symmetry differ by rounding errors. With the relative margin of 1e-9
            // all sectors choose the same diagonal.
            if (d == 0 || length < shortest * (1 - 1e-9)) {
                best = d;
                shortest = length;
            }
        }
        const std::size_t p = 2 * ((best + 1) % 3), q = 2 * ((best + 2) % 3);
        const std::array<Index, 4> belt{n[p], n[q], n[p + 1], n[q + 1]};
        for (std::size_t a = 0; a < 4; ++a)
            add_tetrahedron(mesh_, {n[2 * best], n[2 * best + 1], belt[a], belt[(a + 1) % 4]});
    }

    Real radius_;
    int shells_;
    Real angle_;
    std::array<Vec3, 12> corner_;
    std::map<Key, Index> row_;
    Mesh mesh_;
};

}  // namespace

Mesh ball(Real radius, int resolution) {
    require_size("ball", "radius", radius);
    require_count("ball", "resolution", resolution);
    const int shells = resolution / 2 + resolution % 2;
    require_fits("ball", "resolution", 20.0 * shells * shells * shells);
    return BallBuilder(radius, shells).build();
}

Mesh sphere_picture(Real radius) {
    constexpr int resolution = 8;
    const SurfaceMesh skin = boundary(ball(radius, resolution));
    // The 12 corners of the icosahedron become the first nodes after the centre. They are found by their number of
    // surface triangles: five, whereas other surface nodes have six.
    std::vector<int> faces(skin.nodes.size(), 0);
    for (const auto& triangle : skin.triangles)
        for (const Index n : triangle) ++faces[static_cast<std::size_t>(n)];
    Mesh picture;
    picture.nodes.push_back(Vec3::Zero());
    std::vector<Index> row(skin.nodes.size());
    for (const bool corners : {true, false})
        for (std::size_t n = 0; n < skin.nodes.size(); ++n) {
            if ((faces[n] == 5) != corners) continue;
            row[n] = static_cast<Index>(picture.nodes.size());
            picture.nodes.push_back(skin.nodes[n]);
        }
    for (const auto& [a, b, c] : skin.triangles)
        picture.tetrahedra.push_back(
            {0, row[static_cast<std::size_t>(a)], row[static_cast<std::size_t>(b)], row[static_cast<std::size_t>(c)]});
    return picture;
}

}  // namespace skerry::mesh
