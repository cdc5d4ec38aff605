// A hollow sphere whose cavity contains a gas or a liquid.
#pragma once

#include "skerry/cavity.h"
#include "skerry/world.h"
#include "tests/support/hollow_sphere.h"
#include "tests/support/worlds.h"

namespace skerry::test::filled_sphere {

inline const Vec3 no_gravity = Vec3::Zero();
inline constexpr Real inner = 0.08, outer = 0.1;  // radii of the hollow sphere [m]
inline const Mesh& sphere_mesh() {
    static const Mesh mesh = hollow_sphere(inner, outer, 2, 1);
    return mesh;
}

/// A hollow sphere without gravity.
struct HollowSphere {
    World world;
    BodyHandle body;
    CavityHandle cavity;

    HollowSphere(const decltype(CavitySettings::filling)& filling, MaterialSettings material,
                 BodyDynamics dynamics = BodyDynamics::explicit_elastic, Settings settings = accurate(no_gravity),
                 const Mesh& mesh = sphere_mesh())
        : world(settings) {
        body = world.add_body(mesh, {.material = world.add_material(material), .dynamics = dynamics, .name = "shell"});
        cavity = Cavities(world).add({.body = body, .filling = filling});
    }
    CavityState state() { return Cavities(world).state(cavity); }
};

inline const GasFilling pressurised{.pressure = 2e4};
inline MaterialSettings rubber(Real damping = 0) {
    return lossless({.young_modulus = 1e6, .poisson_ratio = 0.3, .damping = damping});
}

}  // namespace skerry::test::filled_sphere
