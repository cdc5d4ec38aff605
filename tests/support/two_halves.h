// A bar of two halves whose meshes do not match, joined by a tie.
#pragma once

#include <cmath>
#include <vector>

#include "skerry/tie.h"
#include "tests/support/worlds.h"

namespace skerry::test::two_halves {

inline constexpr Real side = 0.1, half = 0.2;  // width and half of the length of a bar along x [m]

/// Numbers of the nodes of a mesh whose coordinate x is `x`.
inline std::vector<Index> nodes_at(const Mesh& mesh, Real x) {
    std::vector<Index> found;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n].x() - x) < 1e-9) found.push_back(static_cast<Index>(n));
    return found;
}

inline Settings without_gravity(Real tolerance = 1e-10) {
    return accurate(Vec3::Zero(), tolerance);
}

inline const Mesh coarse = mesh::box({half, side, side}, {4, 2, 2}), fine = mesh::box({half, side, side}, {6, 3, 3});
inline const MaterialSettings rubber{.young_modulus = 1e6, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0};

/// Two halves of a bar, whose meshes do not match. The fine one is tied to the coarse one.
struct TwoHalves {
    World world;
    BodyHandle left, right;
    TieHandle tie;
    std::vector<Index> tied = nodes_at(fine, -half / 2);

    explicit TwoHalves(const Settings& settings = without_gravity(), const TieSettings& with = {},
                       BodyDynamics left_dynamics = BodyDynamics::explicit_elastic,
                       BodyDynamics right_dynamics = BodyDynamics::explicit_elastic,
                       const MaterialSettings& material = rubber, ElementKind element = ElementKind::smoothed)
        : world(settings) {
        const MaterialHandle handle = world.add_material(material);
        const auto add = [&](const Mesh& mesh, Real x, BodyDynamics dynamics) {
            return world.add_body(
                mesh, {.material = handle, .position = {x, 0, 0}, .dynamics = dynamics, .element = element});
        };
        left = add(coarse, -half / 2, left_dynamics);
        right = add(fine, half / 2, right_dynamics);
        TieSettings tie_settings = with;
        tie_settings.body = right;
        tie_settings.nodes = tied;
        tie_settings.to_body = left;
        tie = Ties(world).add(tie_settings);
    }
};

}  // namespace skerry::test::two_halves
