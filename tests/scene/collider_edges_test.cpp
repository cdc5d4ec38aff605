// Sharp and round parts of colliders touch a body between its nodes.
#include <catch2/catch.hpp>
#include <numbers>

#include "systems/collision/narrow/collider_distance.h"
#include "systems/geometry/rotation.h"
#include "tests/support/worlds.h"

namespace skerry::test::collider_edges_test {

namespace {

constexpr Real pi = std::numbers::pi;

/// A shape that is pressed from above into a block, 20 x 20 x 10 cm, on a fixed floor.
struct Press {
    const char* name;
    Shape shape;
    ColliderGeometry geometry;
    Vec3 rotation;
    Real lowest;              // lowest point of the shape below its origin [m]
    Vec3 beside;              // horizontal offset from the middle of the block [m]
    Real depth;               // m
    bool to_the_end = false;  // also run with cells of 6 mm
};

/// Rotation that points one corner of a box straight down.
Vec3 corner_down() {
    const Vec3 corner = Vec3(-1, -1, -1).normalized(), down(0, 0, -1);
    const Vec3 axis = corner.cross(down);
    return std::asin(axis.norm()) * axis.normalized();
}

const Press presses[] = {
    {"corner of a box",
     Box{{0.06, 0.06, 0.06}},
     {ColliderShape::box, {0.03, 0.03, 0.03}},
     corner_down(),
     0.03 * std::sqrt(3.0),
     {0.011, 0.006, 0},
     0.02,
     true},
    {"edge of a box",
     Box{{0.3, 0.05, 0.05}},
     {ColliderShape::box, {0.15, 0.025, 0.025}},
     {pi / 4, 0, 0},
     0.025 * std::sqrt(2.0),
     {0, 0.011, 0},
     0.015},
    {"face of a box",
     Box{{0.03, 0.03, 0.05}},
     {ColliderShape::box, {0.015, 0.015, 0.025}},
     {0, 0, 0.2},
     0.025,
     {0.02, 0.011, 0},
     0.01},
    {"ball", Sphere{0.012}, {ColliderShape::sphere, {0.012, 0, 0}}, Vec3::Zero(), 0.012, {0.011, 0.006, 0}, 0.02, true},
    {"end of a capsule",
     Capsule{0.008, 0.05},
     {ColliderShape::capsule, {0.008, 0.025, 0}},
     {0.2, 0, 0},
     0.008 + 0.025 * std::cos(0.2),
     {0.011, 0.006, 0},
     0.02,
     true},
    {"side of a capsule",
     Capsule{0.01, 0.1},
     {ColliderShape::capsule, {0.01, 0.05, 0}},
     {pi / 2, 0, 0},
     0.01,
     {0.011, 0, 0},
     0.015},
    {"end of a cylinder",
     Cylinder{0.012, 0.05},
     {ColliderShape::cylinder, {0.012, 0.025, 0}},
     {0, 0, 0},
     0.025,
     {0.011, 0.006, 0},
     0.01},
    {"rim of a cylinder",
     Cylinder{0.02, 0.05},
     {ColliderShape::cylinder, {0.02, 0.025, 0}},
     {0.5, 0, 0},
     0.025 * std::cos(0.5) + 0.02 * std::sin(0.5),
     {0.011, 0.006, 0},
     0.015},
    {"rim of a bucket",
     Bucket{0.04, 0.05, 0.004},
     {ColliderShape::bucket, {0.04, 0.05, 0.004}},
     {pi, 0, 0},
     0.05,
     {0.006, 0.002, 0},
     0.015,
     true},
    {"bottom rim of a bucket",
     Bucket{0.02, 0.05, 0.004},
     {ColliderShape::bucket, {0.02, 0.05, 0.004}},
     {0.5, 0, 0},
     0.004 * std::cos(0.5) + 0.024 * std::sin(0.5),
     {0.011, 0.006, 0},
     0.015},
};

struct Pressed {
    Real overlap = 0;  // over the run: largest depth of the block's surface inside the shape [m]
    Real force = 0;    // upward force on the shape at its final depth [N]
};

/// Largest depth of the block's surface in the shape. Also samples the faces between their nodes.
Real deepest(const World& world, BodyHandle block, const Press& press, const MotionKey& pose) {
    const RigidMotion motion{pose.position, rotation_matrix(pose.rotation), Vec3::Zero(), Vec3::Zero()};
    const auto x = world.positions(block);
    constexpr int cuts = 24;
    Real deepest = 0;
    for (const auto& t : world.surface(block))
        for (int i = 0; i <= cuts; ++i)
            for (int j = 0; i + j <= cuts; ++j) {
                const Real u = Real(i) / cuts, v = Real(j) / cuts;
                const Vec3 p = (1 - u - v) * x[std::size_t(t[0])] + u * x[std::size_t(t[1])] + v * x[std::size_t(t[2])];
                deepest = std::max(deepest, -distance_to_collider(press.geometry, motion, p).distance);
            }
    return deepest;
}

Pressed press_block(const Press& press, int cells) {
    World world(accurate(Vec3::Zero(), 1e-4));
    const auto material =
        world.add_material({.young_modulus = 5e4, .poisson_ratio = 0.3, .friction = 0.3, .damping = 100});
    const Vec3 size(0.2, 0.2, 0.1);
    const Mesh mesh = mesh::box(size, {2 * cells, 2 * cells, cells});
    const auto block = world.add_body(mesh, {.material = material, .name = "block"});
    std::vector<Index> floor;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z() < -size.z() / 2 + 1e-9) floor.push_back(static_cast<Index>(n));
    world.attach(block, floor);

    const Vec3 above = press.beside + Vec3(0, 0, size.z() / 2 + press.lowest + 0.002);
    const Vec3 end = above - Vec3(0, 0, press.depth + 0.002);
    constexpr Real pressing = 0.15, holding = 0.15;
    const auto collider = world.add_collider(
        press.shape,
        {.motion = {.keys = {{0, above, press.rotation}, {pressing, end, press.rotation}, {1, end, press.rotation}}},
         .name = "shape"});
    Pressed pressed;
    for (Real t = 0; t < pressing + holding; t += 0.005) {
        const StepReport report = world.advance(0.005);
        REQUIRE(report.ok());
        pressed.overlap = std::max(pressed.overlap, deepest(world, block, press, world.pose(collider)));
    }
    const Real step = 0.005 / std::ceil(0.005 / world.stable_step());
    for (const Contact& c : world.contacts()) pressed.force -= c.impulse.z() / step;
    return pressed;
}

}  // namespace

TEST_CASE(
    "corners, edges, rims and ends of colliders that are pressed between the nodes of a coarse block do not enter it",
    "[scene][long]") {
    for (const Press& press : presses) {
        INFO(press.name);
        const Pressed pressed = press_block(press, 2);
        CHECK(pressed.overlap == 0);
        CHECK(pressed.force > 1);
    }
}

TEST_CASE("the force of a punch converges as the cells of the block become finer", "[scene][slow]") {
    for (const Press& press : presses) {
        INFO(press.name);
        const Real f2 = press_block(press, 2).force, f4 = press_block(press, 4).force, f8 = press_block(press, 8).force;
        CHECK(f4 < f2);
        CHECK(f8 < f4);
        if (!press.to_the_end) continue;
        const Pressed finest = press_block(press, 16);
        CHECK(finest.force < f8);
        CHECK(finest.overlap < 1e-5);
        CHECK(f8 - finest.force < 0.55 * (f4 - f8));  // at least first order
    }
}

}  // namespace skerry::test::collider_edges_test
