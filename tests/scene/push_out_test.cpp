// Bodies may start touching: those that start within the contact distance, or overlapping, are moved apart without a
// hop (docs/methods/contact.md 3.4).
#include <catch2/catch.hpp>

#include "tests/support/worlds.h"

namespace skerry::test::scene_push_out_test {

TEST_CASE("a block that starts on a floor, or in it, is lifted and not thrown", "[scene][long]") {
    constexpr Real height = 0.2;
    for (Real young_modulus : {1e4, 1e5, 1e7, 1e9})
        for (Real start : {0.0, 1e-4, -1e-4, -2e-3}) {
            World world(Settings{.start_overlaps = StartOverlaps::ignore});
            const auto material = world.add_material(
                {.young_modulus = young_modulus, .poisson_ratio = 0.3, .loss_factor = 0.05, .bulk_viscosity = 0.06});
            world.add_collider(Plane{});
            const auto block = world.add_body(mesh::box({0.4, 0.4, height}, {4, 4, 2}),
                                              {.material = material, .position = {0, 0, height / 2 + start}});
            const Real shell = world.contact_distance(block) / 2;  // the block's share; the plane has none
            const Real sag = 1000 * standard_gravity * height * height / young_modulus;
            Real peak = 0;
            for (int i = 0; i < 100; ++i) {
                REQUIRE(world.advance(0.02).ok());
                peak = std::max(peak, world.center_of_mass(block).z());
            }
            INFO("E " << young_modulus << " Pa, lower face at " << start << " m");
            // `lowest` is the height of the lowest nodes; a soft block also sags.
            Real lowest = 1;
            for (const Vec3& x : world.positions(block)) lowest = std::min(lowest, x.z());
            CHECK(lowest == Approx(shell).margin(2e-5 + 3e-3 * sag));
            CHECK(peak < height / 2 + shell + std::max(1e-4, 0.1 * -start));
            const WorldReport report = world.report();
            CHECK(report.max_penetration <= std::max(0.0, -start) * 1.0001 + 1e-9);
        }
}

}  // namespace skerry::test::scene_push_out_test
