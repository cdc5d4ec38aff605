// Rigid bodies that lean on each other stand as long as a line of thrust fits inside them (docs/accuracy.md, items 50
// and 51).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/support/accuracy.h"
#include "tests/support/worlds.h"

namespace skerry::test::masonry_test {

using accuracy::Tolerance;

namespace {

constexpr Real pi = std::numbers::pi;

/// A semicircular arch of `stones` (even) equal stones with flat faces, with a mean radius of 1 m, on the floor.
struct Arch {
    int stones;
    Real thickness;  // m

    Real inner() const { return 1 - thickness / 2; }
    Real outer() const { return 1 + thickness / 2; }

    /// Clearance between the best line of thrust and the faces of half the arch, in units of weight times length;
    /// negative if no line fits. The line starts at the crown with the thrust H at the height y. Above a joint at the
    /// angle phi the weight is W and its moment M. The resultant meets the joint at the radius (M + H y) / (H cos phi +
    /// W sin phi).
    Real room() const {
        const Real turn = pi / stones, a = inner(), b = outer(), weight = (b * b - a * a) / 2 * std::sin(turn);
        const Real center = 2.0 / 3 * std::cos(turn / 2) * (b * b * b - a * a * a) / (b * b - a * a);
        const auto room_at = [&](Real thrust) {
            Real lowest = -1e9, highest = 1e9, above = 0, moment = 0;
            for (int joint = 0; joint <= stones / 2; ++joint) {
                const Real phi = joint * turn, across = thrust * std::cos(phi) + above * std::sin(phi);
                lowest = std::max(lowest, a * across - moment);
                highest = std::min(highest, b * across - moment);
                above += weight;
                moment += weight * center * std::sin(phi + turn / 2);
            }
            return highest - lowest;
        };
        Real low = 0, high = 10 * weight * stones;  // upper bound; the clearance is concave in the thrust
        for (int k = 0; k < 200; ++k) {
            const Real third = (high - low) / 3;
            if (room_at(low + third) < room_at(high - third))
                low += third;
            else
                high -= third;
        }
        return room_at(low);
    }
};

/// Thickness of the thinnest arch with a line of thrust [m]
Real thinnest(int stones) {
    Real low = 0.01, high = 0.5;
    for (int k = 0; k < 60; ++k) {
        const Real middle = (low + high) / 2;
        (Arch{stones, middle}.room() < 0 ? low : high) = middle;
    }
    return high;
}

/// Descent of the crown after a second, or as soon as it exceeds a millimetre [m]
Real sunk(const Arch& arch) {
    Settings settings = accurate({0, 0, -standard_gravity}, 1e-8);
    settings.step_size = 1.0 / 240;
    settings.max_iterations = 2000;
    World world(settings);
    const auto stone = world.add_material({.density = 2000, .friction = 1});
    world.add_collider(Plane{});
    std::vector<BodyHandle> bodies;
    for (int k = 0; k < arch.stones; ++k) {
        Mesh mesh = mesh::box({1, 0.3, arch.thickness}, {1, 1, 1});
        for (Vec3& x : mesh.nodes) {
            const Real phi = -pi / 2 + pi * (k + 0.5 + x.x()) / arch.stones, radius = 1 + x.z();
            x = Vec3(radius * std::sin(phi), x.y(), radius * std::cos(phi));
        }
        bodies.push_back(
            world.add_body(mesh, {.material = stone, .contact_distance = 0, .dynamics = BodyDynamics::rigid}));
    }
    const BodyHandle crown = bodies[static_cast<std::size_t>(arch.stones / 2)];
    const Real start = world.center_of_mass(crown).z();
    Real down = 0;
    for (int k = 0; k < 20 && down < 1e-3; ++k) {
        REQUIRE(world.advance(0.05).ok());
        down = start - world.center_of_mass(crown).z();
    }
    return down;
}

/// Two cards of 0.2 m that lean on each other. Their inner faces deviate from the vertical by the tangent `slope`.
struct CardHouse {
    static constexpr Real length = 0.2, thickness = 0.01, shell = 1e-3;  // m

    Real slope, friction;

    /// Descent of the middles of the cards after two seconds [m]
    Real sunk() const {
        Settings settings = accurate({0, 0, -standard_gravity}, 1e-10);
        settings.step_size = 1e-3;
        World world(settings);
        const auto paper = world.add_material({.density = 500, .friction = friction});
        world.add_collider(Plane{});
        const Mesh mesh = mesh::box({thickness, 0.1, length}, {1, 2, 4});
        const Real angle = std::atan(slope), sine = std::sin(angle), cosine = std::cos(angle);
        std::vector<BodyHandle> cards;
        for (const Real side : {-1.0, 1.0}) {
            // The inner face goes from its foot, half a shell above the floor, to its top, half a shell from the other.
            const Real x = shell / 2 + length / 2 * sine + thickness / 2 * cosine;
            const Real z = shell / 2 + length / 2 * cosine + thickness / 2 * sine;
            cards.push_back(world.add_body(mesh, {.material = paper,
                                                  .position = {side * x, 0, z},
                                                  .rotation = {0, -side * angle, 0},
                                                  .contact_distance = shell,
                                                  .dynamics = BodyDynamics::rigid}));
        }
        const Real start = world.center_of_mass(cards[0]).z();
        REQUIRE(world.advance(2).ok());
        return start - world.center_of_mass(cards[0]).z();
    }
};

}  // namespace

TEST_CASE("an arch of rigid stones stands while a line of thrust fits into it", "[scene][accuracy]") {
    CHECK(thinnest(400) == Approx(0.1075).margin(2e-4));  // the known limit for many stones
    struct Case {
        int stones;
        Real share;
    };
    for (const Case& test_case : {Case{8, 1.01}, Case{8, 0.99}, Case{12, 1.03}, Case{12, 0.97}}) {
        const Real down = sunk({test_case.stones, test_case.share * thinnest(test_case.stones)});
        const std::string name = "arch of " + std::to_string(test_case.stones) + " rigid stones, " +
                                 std::to_string(test_case.share).substr(0, 4) + " of the least thickness, ";
        if (test_case.share > 1)
            accuracy::check({.item = 50,
                             .name = name + "crown sunk in 1 s (m)",
                             .formula = "0 while a line of thrust fits",
                             .found = down,
                             .tolerance = 1e-9,
                             .kind = Tolerance::absolute});
        else
            accuracy::check({.item = 50,
                             .name = name + "it fell within 1 s, 1 = yes",
                             .formula = "no line of thrust fits",
                             .expected = 1,
                             .found = down > 1e-3 ? 1.0 : 0.0,
                             .tolerance = 0,
                             .kind = Tolerance::absolute});
    }
}

TEST_CASE("a house of two rigid cards stands as long as its feet do not slip", "[scene][accuracy]") {
    constexpr Real mu = 0.25, limit = 2 * mu + CardHouse::thickness / CardHouse::length;
    for (const Real share : {0.99, 1.01}) {
        const Real down = CardHouse{share * limit, mu}.sunk();
        if (share < 1)
            accuracy::check({.item = 51,
                             .name = "house of two rigid cards, 0.99 of the slope at which it falls, sunk in 2 s (m)",
                             .formula = "0 while tan(theta) <= 2 mu + d/L",
                             .found = down,
                             .tolerance = 1e-9,
                             .kind = Tolerance::absolute});
        else
            accuracy::check({.item = 51,
                             .name = "the same, 1.01 of it, it fell within 2 s, 1 = yes",
                             .formula = "tan(theta) > 2 mu + d/L",
                             .expected = 1,
                             .found = down > 0.01 ? 1.0 : 0.0,
                             .tolerance = 0,
                             .kind = Tolerance::absolute});
    }
}

}  // namespace skerry::test::masonry_test
