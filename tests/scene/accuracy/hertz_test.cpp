// Hertz contact, at rest and in an impact (docs/accuracy.md, item 21). Linear tetrahedra are too stiff around a
// contact, with an error of second order in their size. Two meshes and Richardson's extrapolation give the limit.
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/graded_half_ball.h"
#include "tests/support/worlds.h"

namespace skerry::test::hertz_test {

using accuracy::Tolerance;

namespace {

constexpr Real modulus = 1e5, nu = 0.3, density = 1000, reduced = modulus / (1 - nu * nu);  // Pa, -, kg/m^3, Pa
const Real c = std::sqrt(modulus / density);                                                // m/s
// contact radius and contact distance [m]
constexpr Real a = 0.01, shell = a / 50;

MaterialSettings hertz_material() {
    return test::lossless({.young_modulus = modulus,
                           .poisson_ratio = nu,
                           .density = density,
                           .friction = 0,
                           .model = MaterialModel::linear});
}

Settings weightless() {
    Settings settings;
    settings.gravity = Vec3::Zero();
    return settings;
}

/// Area of each surface node: a third of each triangle around it [m^2]
std::vector<Real> node_areas(const World& world, BodyHandle body) {
    std::vector<Real> area(world.positions(body).size(), 0);
    for (const auto& t : world.surface(body)) {
        const auto at = [&](std::size_t i) { return world.positions(body)[static_cast<std::size_t>(t[i])]; };
        for (Index n : t) area[static_cast<std::size_t>(n)] += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6;
    }
    return area;
}

struct Pressed {
    Real force, radius, pressure;  // relative to Hertz's values
};

/// Presses a rigid ball into the half space z < 0 until the contact radius a has `fine` elements. Force and radius are
/// means while the edge of the contact moves from half an element before a to half an element beyond. Without the mean,
/// the position of the edge between nodes changes them by some per cent.
Pressed press(int fine, ElementKind element) {
    constexpr Real radius = 10 * a;  // of the ball [m]
    World world(weightless());
    const auto material = world.add_material(hertz_material());
    const HalfBallShape shape{.a = a, .fine = fine, .growth = 4, .radius = 20 * a};
    const Mesh mesh = graded_half_ball(shape);
    const auto ground = world.add_body(mesh, {.material = material, .contact_distance = shell, .element = element});
    // The far end is held. Waves reflected there return after the end of the run.
    std::vector<Index> far;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].norm() > 0.99 * shape.shell_radius(shape.shells())) far.push_back(static_cast<Index>(n));
    world.attach(ground, far);
    // The anchor is the node on the axis nearest to a depth of 7 a.
    std::size_t anchor = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if ((mesh.nodes[n] + Vec3(0, 0, 7 * a)).norm() < (mesh.nodes[anchor] + Vec3(0, 0, 7 * a)).norm()) anchor = n;
    const Real quick = 12 * a / c, slow = 24 * a / c, start = radius + shell / 2;  // s, s, m
    const auto edge = [fine](Real part) { return a * (1 + (part - 0.5) / fine); };
    const auto depth_of = [](Real contact_radius) { return contact_radius * contact_radius / radius; };
    ColliderSettings ball;
    for (int k = 0; k <= 20; ++k) {
        const Real s = k / 20.0;
        ball.motion.keys.push_back({quick * s, {0, 0, start - depth_of(edge(0)) * s * s * (3 - 2 * s)}, Vec3::Zero()});
    }
    for (int k = 1; k <= 20; ++k)
        ball.motion.keys.push_back({quick + slow * k / 20.0, {0, 0, start - depth_of(edge(k / 20.0))}, Vec3::Zero()});
    ball.position = {0, 0, start};
    world.add_collider(Sphere{radius}, ball);
    REQUIRE(world.advance(quick).ok());
    const std::vector<Real> areas = node_areas(world, ground);
    Pressed mean{};
    constexpr int samples = 200;
    for (int k = 0; k < samples; ++k) {
        const Real step = world.advance(slow / samples).step_size;
        const Real sunk = start - world.pose(world.colliders()[0]).position.z();
        Real force = 0, moment = 0, middle = 0;
        for (const Contact& contact : world.contacts()) {
            const Real push = contact.impulse.norm() / step;
            Vec3 place = Vec3::Zero();  // the contact point on a node, an edge or a face
            for (std::size_t part = 0; part < 4; ++part) {
                if (contact.weight[part] == 0) continue;
                const std::size_t n = static_cast<std::size_t>(contact.node[part]);
                place += contact.weight[part] * mesh.nodes[n];
                if (mesh.nodes[n].norm() < a / fine / 2) middle += contact.weight[part] * push / areas[n];
            }
            force += push;
            moment += push * place.squaredNorm();
        }
        // Approach of a half space: the part beyond the anchor yields as under a point force (Boussinesq).
        const Real moved = world.positions(ground)[anchor].z() - mesh.nodes[anchor].z();
        const Real depth =
            sunk + moved + force * (1 + nu) * (3 - 2 * nu) / (2 * std::numbers::pi * modulus * -mesh.nodes[anchor].z());
        mean.force += force / (4.0 / 3 * reduced * std::sqrt(radius) * std::pow(depth, 1.5)) / samples;
        // The mean of r^2 under Hertz's pressure is 2 a^2 / 5.
        mean.radius += std::sqrt(2.5 * moment / force / (radius * depth)) / samples;
        mean.pressure += middle / (2 * reduced * std::sqrt(depth / radius) / std::numbers::pi) / samples;
    }
    return mean;
}

/// Drops an elastic ball of a given radius [m] on a plane at the speed at which its contact grows to the radius a.
/// Returns the duration of the contact over Hertz's.
Real bounce(Real ball_radius, int fine, ElementKind element) {
    World world(weightless());
    const auto material = world.add_material(hertz_material());
    Mesh mesh = graded_half_ball({.a = a, .fine = fine, .growth = 2.5, .radius = 4 * ball_radius});
    roll_up(mesh, ball_radius);
    world.add_collider(Plane{});
    const auto ball = world.add_body(
        mesh, {.material = material, .position = {0, 0, shell / 2}, .contact_distance = shell, .element = element});
    const Real mass = world.mass(ball), deepest = a * a / ball_radius;
    // E* sqrt(R) d^2.5 8 / 15 = m v^2 / 2
    const Real v = std::sqrt(16.0 / 15 * reduced * std::sqrt(ball_radius) * std::pow(deepest, 2.5) / mass);
    const Real expected = 2.87 * std::pow(mass * mass / (ball_radius * reduced * reduced * v), 0.2);
    Real last = 0;
    world.set_velocities(ball, std::vector<Vec3>(mesh.nodes.size(), Vec3(0, 0, -v)));
    while (world.time() < 1.3 * expected) {
        REQUIRE(world.advance(world.stable_step()).ok());
        for (const Contact& contact : world.contacts())
            if (contact.impulse.z() > 0) last = world.time();
    }
    REQUIRE(world.contacts().empty());
    return last / expected;
}

}  // namespace

TEST_CASE("a rigid ball presses into an elastic half space as Hertz has it", "[scene][accuracy]") {
    const Pressed coarse = press(4, ElementKind::linear), fine = press(8, ElementKind::linear);
    const auto limit = [](Real of_coarse, Real of_fine) { return of_fine + (of_fine - of_coarse) / 3; };
    accuracy::check({.item = 21,
                     .name = "Hertz, force over the formula",
                     .formula = "(4/3) E* sqrt(R) d^1.5",
                     .expected = 1,
                     .found = limit(coarse.force, fine.force),
                     .tolerance = 0.03,
                     .note = "Linear tetrahedra are too stiff around a contact, by an error of second order (force 18 "
                             "% too large with 4 elements to the "
                             "contact radius, 6 % with 8): the values are the limit of 4 and 8 (Richardson)."});
    accuracy::check({.item = 21,
                     .name = "Hertz, contact radius over the formula",
                     .formula = "sqrt(R d)",
                     .expected = 1,
                     .found = limit(coarse.radius, fine.radius),
                     .tolerance = 0.03});
    accuracy::check({.item = 21,
                     .name = "Hertz, pressure in the middle over the formula",
                     .formula = "2 E* sqrt(d / R) / pi",
                     .expected = 1,
                     .found = limit(coarse.pressure, fine.pressure),
                     .tolerance = 0.04});
}

TEST_CASE("an elastic ball bounces in the time that Hertz gives", "[scene][accuracy]") {
    const Real small = bounce(5 * a, 4, ElementKind::linear), large = bounce(10 * a, 4, ElementKind::linear);
    const std::string formula = "2.87 (m^2 / (R E*^2 v))^(1/5)";
    accuracy::check({.item = 21,
                     .name = "ball on a plane, a / R = 0.1, a / h = 4, contact time over the formula",
                     .formula = formula,
                     .expected = 1,
                     .found = large,
                     .tolerance = 0.08,
                     .note = "The contact time is tested at a / h = 4 and 8 %, not at 10 and 3 %: Hertz's formula is "
                             "that of a ball much larger than its "
                             "contact (found "
                             "0.912, 0.936 and 0.949 of it at a / R = 0.2, 0.1 and 0.05), and a mesh that is fine "
                             "enough for both lengths takes minutes. A "
                             "finer one comes closer: 0.925 and 0.943 at 0.2 and 0.1 with a / h = 6."});
    accuracy::check({.item = 21,
                     .name = "the same, limit of a / R = 0.2 and 0.1",
                     .formula = formula,
                     .expected = 1,
                     .found = 2 * large - small,
                     .tolerance = 0.06});
}

TEST_CASE("smoothed elements press and bounce as Hertz has it on the coarse mesh", "[scene][accuracy]") {
    const Pressed pressed = press(4, ElementKind::smoothed);
    const std::string mesh = "Hertz, 4 smoothed elements to the contact radius, ";
    accuracy::check({.item = 21,
                     .name = mesh + "force over the formula",
                     .formula = "(4/3) E* sqrt(R) d^1.5",
                     .expected = 1,
                     .found = pressed.force,
                     .tolerance = 0.05,
                     .note = "Smoothed elements: one mesh, no extrapolation. Linear ones are 18 % off there."});
    accuracy::check({.item = 21,
                     .name = mesh + "contact radius over the formula",
                     .formula = "sqrt(R d)",
                     .expected = 1,
                     .found = pressed.radius,
                     .tolerance = 0.02});
    accuracy::check({.item = 21,
                     .name = mesh + "pressure in the middle over the formula",
                     .formula = "2 E* sqrt(d / R) / pi",
                     .expected = 1,
                     .found = pressed.pressure,
                     .tolerance = 0.03});
    accuracy::check({.item = 21,
                     .name = "smoothed ball on a plane, a / R = 0.1, a / h = 3, contact time over the formula",
                     .formula = "2.87 (m^2 / (R E*^2 v))^(1/5)",
                     .expected = 1,
                     .found = bounce(10 * a, 3, ElementKind::smoothed),
                     .tolerance = 0.03});
}

}  // namespace skerry::test::hertz_test
