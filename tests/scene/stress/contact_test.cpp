// Stress suite: fast and deep contacts, pinched sheets, large friction in a whole step (items 8, 9, 13 and 21 of
// docs/stress.md).
#include <catch2/catch.hpp>

#include "tests/support/stress.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

namespace skerry::test::contact_test {

using namespace skerry::test::stress;

namespace {

SurfaceView view(const World& world, BodyHandle body) {
    return {world.positions(body), world.surface(body)};
}

/// Number of times that a ray from `point` leaves through the surface minus the number of times that it enters. For a
/// layer whose rim surrounds the ray it is not 0 behind the layer.
int winding_along(const SurfaceView& surface, const Vec3& point, const Vec3& direction, Real length) {
    const Vec3 end = point + length * direction;
    int sum = 0;
    for (const auto& f : surface.triangle) {
        const Vec3 &a = surface.at(f[0]), &b = surface.at(f[1]), &c = surface.at(f[2]);
        if (passes_through(point, end, a, b, c)) sum += (b - a).cross(c - a).dot(direction) > 0 ? 1 : -1;
    }
    return sum;
}

std::vector<Index> rim_of(const Mesh& mesh, Real half) {
    std::vector<Index> rim;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::max(std::abs(mesh.nodes[n].x()), std::abs(mesh.nodes[n].y())) > half - 1e-9)
            rim.push_back(static_cast<Index>(n));
    return rim;
}

Settings weightless() {
    Settings settings;
    settings.gravity = Vec3::Zero();
    return settings;
}

}  // namespace

TEST_CASE("a ball at 100 m/s does not go through a sheet of one layer", "[scene][stress]") {
    for (const Real modulus : {1e6, 1e8}) {
        World world(weightless());
        const auto rubber = world.add_material({.young_modulus = 1e6, .density = 1000, .friction = 0.3});
        const auto cloth = world.add_material({.young_modulus = modulus, .density = 1000, .friction = 0.3});
        const Mesh mesh = mesh::box({0.4, 0.4, 0.01}, {12, 12, 1});
        const auto sheet = world.add_body(mesh, {.material = cloth, .name = "sheet"});
        world.attach(sheet, rim_of(mesh, 0.2));
        const auto ball = world.add_body(
            mesh::ball(0.04, 4),
            {.material = rubber, .position = {0.007, 0.011, 0.1}, .velocity = {0, 0, -100}, .name = "ball"});
        // Top face of the sheet: nodes behind it have gone through.
        std::vector<std::array<Index, 3>> top;
        for (const auto& t : world.surface(sheet)) {
            Real lowest = 1;
            for (const Index n : t) lowest = std::min(lowest, mesh.nodes[static_cast<std::size_t>(n)].z());
            if (lowest > 0) top.push_back(t);
        }
        int most_crossings = 0;
        Course whole;
        for (int look = 0; look < 200 && whole.ok; ++look) {
            const Course course = follow(world, 2e-5, 1);
            whole.ok = course.ok;
            whole.message = course.message;
            whole.finite &= course.finite;
            most_crossings = std::max(most_crossings, crossings(view(world, sheet), view(world, ball)));
        }
        int behind = 0;
        std::vector<Index> skin;  // inner nodes have no contacts, and a ball this fast is pressed flat
        for (const auto& triangle : world.surface(ball)) skin.insert(skin.end(), triangle.begin(), triangle.end());
        std::sort(skin.begin(), skin.end());
        skin.erase(std::unique(skin.begin(), skin.end()), skin.end());
        for (const Index n : skin)
            behind += winding_along({world.positions(sheet), top}, world.positions(ball)[static_cast<std::size_t>(n)],
                                    Vec3::UnitZ(), 10) != 0;
        const std::string scene =
            "ball of 4 cm at 100 m/s on a held sheet of one layer, " + text(modulus) + " Pa, 4 ms";
        judge({8, scene, "finite; steps taken, or refused with a report", whole.ok ? "all steps" : whole.message,
               whole.finite});
        at_most(8, scene, "edges through triangles", most_crossings, 0);
        at_most(8, scene, "surface nodes of the ball behind the sheet", behind, 0);
    }
}

TEST_CASE("a body that starts deep inside another is pushed out gently", "[scene][stress]") {
    // The push moves the nodes that are inside, with push_speed at most, and elasticity moves the rest. A bar whose end
    // is moved at v gets a wave that brings it to v and returns from the far end with 2 v. A rigid body would leave at
    // v at most and without energy; a deformable one leaves at up to 2 v, with the energy of that speed.
    constexpr Real radius = 0.05;
    const Real push_speed = 0.01 * Settings{}.recovery_speed;  // speed without gravity
    struct Case {
        const char* name;
        bool body;
    };
    for (const Case& c : {Case{"half inside a floor", false}, Case{"half inside another", true}}) {
        Settings settings = weightless();
        settings.start_overlaps = StartOverlaps::ignore;
        World world(settings);
        const auto material = world.add_material({.young_modulus = 1e5, .density = 1000, .friction = 0.3});
        const Mesh mesh = mesh::ball(radius, 6);
        const auto ball = world.add_body(mesh, {.material = material, .name = "ball"});
        const std::vector<Real> mass = node_masses(world, ball, mesh, 1000);
        if (c.body)
            world.add_body(mesh, {.material = material, .position = {0.3 * radius, 0.1 * radius, -radius}});
        else
            world.add_collider(Plane{});
        Real fastest = 0, kinetic = 0;
        Course whole;
        for (int look = 0; look < 1500 && whole.ok; ++look) {
            const Course course = follow(world, 0.01, 1);
            whole.ok = course.ok;
            whole.message = course.message;
            whole.finite &= course.finite;
            for (const BodyHandle body : world.bodies())
                fastest = std::max(fastest, mean_velocity(world, body, mass).norm());
            kinetic = std::max(kinetic, world.energy().kinetic);
        }
        const Real allowed =
            0.5 * world.mass(ball) * push_speed * push_speed * static_cast<Real>(world.bodies().size());
        const std::string scene = "ball " + std::string(c.name) + ", 15 s";
        judge({9, scene, "every step taken, finite", whole.ok ? "all steps" : whole.message, whole.ok && whole.finite});
        at_most(9, scene, "exit speed / push speed", fastest / push_speed, 2);
        at_most(9, scene, "kinetic energy / that of the push speed", kinetic / allowed, 4);
        const Energy end = world.energy();
        at_most(9, scene, "kinetic and elastic energy at the end / that of the push speed",
                (end.kinetic + end.elastic) / allowed, 4);
        if (c.body)
            at_most(9, scene, "edges through triangles at the end",
                    crossings(view(world, ball), view(world, world.bodies()[1])), 0);
        else {
            Real lowest = 1;
            for (const Vec3& x : world.positions(ball)) lowest = std::min(lowest, x.z());
            at_least(9, scene, "lowest node at the end, m", lowest, -1e-4);
        }
    }
}

TEST_CASE("a block on a slope of 50 degrees sticks with a friction of a thousand", "[scene][stress]") {
    Settings settings;
    settings.gravity = tilted_gravity(50);
    BlockOnPlane scene(settings, {.young_modulus = 1e6, .friction = 1e3, .damping = 20});
    scene.settle(0.1);
    // The contact nodes must not move.
    const std::vector<Vec3> before(scene.world.positions(scene.block).begin(),
                                   scene.world.positions(scene.block).end());
    const Course course = follow(scene.world, 0.5, 10);
    Real slip = 0;
    int pressing = 0;
    for (const Contact& contact : scene.world.contacts()) {
        if (!(contact.impulse.dot(contact.normal) > 0)) continue;
        ++pressing;
        const auto n = static_cast<std::size_t>(contact.node[0]);
        slip = std::max(slip, (scene.world.positions(scene.block)[n] - before[n]).head<2>().norm());
    }
    const std::string name = "block on a slope of 50 degrees, mu 1e3, 0.5 s";
    judge({13, name, "every step taken, finite", course.ok ? "all steps" : course.message, course.ok && course.finite});
    at_least(13, name, "contacts that press", pressing, 3);
    at_most(13, name, "way of a node that presses, m", slip, 1e-6);
}

TEST_CASE("a sheet pinched between two plates holds still and flat", "[scene][stress]") {
    for (const bool bodies : {false, true}) {
        World world;
        const Real thickness = 0.01, shell = 4e-4;
        const auto cloth = world.add_material({.young_modulus = 1e5, .density = 1000, .friction = 0.8, .damping = 20});
        const Mesh mesh = mesh::box({0.1, 0.1, thickness}, {8, 8, 1});
        const auto sheet = world.add_body(mesh, {.material = cloth, .contact_distance = shell, .name = "sheet"});
        // Two jaws come from both sides and press the sheet to four fifths of its thickness. There is no floor.
        const Real jaw = 0.02;
        std::vector<BodyHandle> jaws;
        for (const Real side : {-1.0, 1.0}) {
            Motion motion;
            const Real open = side * (thickness / 2 + jaw / 2 + 2 * shell),
                       closed = side * (0.4 * thickness + jaw / 2 + shell / 2);
            motion.keys = {{0, {0, 0, open}, Vec3::Zero()},
                           {0.02, {0, 0, closed}, Vec3::Zero()},
                           {10, {0, 0, closed}, Vec3::Zero()}};
            if (!bodies) {
                world.add_collider(Box{{0.05, 0.05, jaw}}, {.motion = motion});
                continue;
            }
            const Mesh block = mesh::box({0.05, 0.05, jaw}, {3, 3, 1});
            const auto stiff =
                world.add_material({.young_modulus = 1e6, .density = 1000, .friction = 0.8, .damping = 20});
            jaws.push_back(
                world.add_body(block, {.material = stiff, .position = {0, 0, open}, .contact_distance = shell}));
            std::vector<Index> back;
            for (std::size_t n = 0; n < block.nodes.size(); ++n)
                if (side * block.nodes[n].z() > jaw / 2 - 1e-9) back.push_back(static_cast<Index>(n));
            world.attach(jaws.back(), back, motion);
        }
        world.set_gravity({-9.81, 0, 0});  // gravity along the sheet, which friction holds
        const Course closing = follow(world, 0.5, 50);
        const Vec3 start = world.center_of_mass(sheet);
        const Course holding = follow(world, 0.4, 40);
        const std::string scene =
            bodies ? "sheet pinched by two deformable jaws, 0.9 s" : "sheet pinched by two rigid jaws, 0.9 s";
        judge({21, scene, "every step taken, finite", closing.message + holding.message + "all steps",
               closing.ok && holding.ok && closing.finite && holding.finite});
        at_most(21, scene, "way of the sheet while it hangs, m", (world.center_of_mass(sheet) - start).norm(), 1e-4);
        at_most(21, scene, "penetration / thickness",
                std::max(closing.max_penetration, holding.max_penetration) / thickness, 1e-2);
        at_most(21, scene, "energy gained while it hangs / in play", holding.gain(), 1e-2);
        for (const BodyHandle body : jaws)
            at_most(21, scene, "edges through triangles", crossings(view(world, sheet), view(world, body)), 0);
    }
}

}  // namespace skerry::test::contact_test
