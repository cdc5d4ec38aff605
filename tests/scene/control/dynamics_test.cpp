// Changes of the dynamics of a body during the run (World::set_dynamics).
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/world_state.h"
#include "skerry/cable.h"
#include "skerry/joint.h"
#include "skerry/spring.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::dynamics_test {

namespace {

constexpr BodyDynamics deformable = BodyDynamics::explicit_elastic, implicit = BodyDynamics::implicit_elastic,
                       rigid = BodyDynamics::rigid;
constexpr Real density = 1000;  // kg/m^3

/// A bar of one or two materials that spins and vibrates in free space, and a distant ball that it never meets.
struct Bar {
    World world;
    Mesh mesh = mesh::box({0.3, 0.1, 0.1}, {6, 2, 2});
    std::vector<Real> mass;
    BodyHandle body, ball;
    std::array<MaterialHandle, 2> material;

    enum Materials { one_material, two_materials };

    explicit Bar(Materials materials = two_materials, int threads = 1, const Vec3& gravity = Vec3::Zero())
        : Bar(materials, lossless({.young_modulus = 1e6, .poisson_ratio = 0.3, .density = density}), threads, gravity) {
    }

    Bar(Materials materials, const MaterialSettings& first, int threads = 1, const Vec3& gravity = Vec3::Zero())
        : world({.gravity = gravity, .backend = Backend::threads, .threads = threads}) {
        material = {world.add_material(first),
                    world.add_material(lossless({.young_modulus = 2e6, .poisson_ratio = 0.48, .density = density}))};
        const int of_fifth = materials == two_materials ? 1 : 0;
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.label.push_back(t % 5 == 0 ? of_fifth : 0);
        body = world.add_body(mesh, {.material = material[0],
                                     .materials = {{of_fifth, material[materials == two_materials ? 1 : 0]}},
                                     .position = {1, 2, 3},
                                     .rotation = {0.3, -0.2, 0.5},
                                     .velocity = {2, 0, 1},
                                     .angular_velocity = {3, 8, -5},
                                     .name = "bar"});
        ball = world.add_body(mesh::ball(0.05, 3), {.material = material[0], .position = {0, 0, 20}, .name = "ball"});
        mass = node_masses(world, body, mesh, density);
    }

    /// Angular momentum about the origin, from the nodes, or from the frame of a rigid or implicit body [kg m^2/s]
    Vec3 angular_momentum() const {
        const Model& model = WorldAccess::state_of(world).model;
        const auto row = static_cast<std::size_t>(model.row(body, "test"));
        if (model.has_frame(row)) return rigid_sums(model, row).angular_momentum;
        Vec3 sum = Vec3::Zero();
        const auto x = world.positions(body), v = world.velocities(body);
        for (std::size_t n = 0; n < x.size(); ++n) sum += mass[n] * x[n].cross(v[n]);
        return sum;
    }
};

/// Two stacked blocks on a floor.
struct Stack {
    World world;
    std::array<BodyHandle, 2> block;
    Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});

    Stack() : world(settings()) {
        const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3, .friction = 0.5});
        for (std::size_t b = 0; b < 2; ++b)
            block[b] =
                world.add_body(mesh, {.material = rubber, .position = {0, 0, 0.0525 + 0.1015 * static_cast<Real>(b)}});
        world.add_collider(Plane{}, {.name = "floor"});
    }
    static Settings settings() {
        Settings settings;
        settings.start_overlaps = StartOverlaps::refuse;
        return settings;
    }
    Real lowest(std::size_t b) const {
        Real z = 1;
        for (const Vec3& x : world.positions(block[b])) z = std::min(z, x.z());
        return z;
    }
};

}  // namespace

TEST_CASE("a body that becomes another kind keeps centre of mass, momentum and angular momentum", "[scene]") {
    Bar bar;
    REQUIRE(bar.world.advance(0.01).ok());
    for (const BodyDynamics next : {rigid, implicit, deformable, implicit, rigid, deformable, rigid}) {
        const Vec3 center = bar.world.center_of_mass(bar.body), turning = bar.angular_momentum();
        const Vec3 velocity = mean_velocity(bar.world, bar.body, bar.mass);
        bar.world.set_dynamics(bar.body, next);
        CAPTURE(name_of(next));
        CHECK(bar.world.dynamics(bar.body) == next);
        CHECK((bar.world.center_of_mass(bar.body) - center).norm() < 1e-14 * 10);
        CHECK((mean_velocity(bar.world, bar.body, bar.mass) - velocity).norm() < 1e-13);
        CHECK((bar.angular_momentum() - turning).norm() < 1e-12 * turning.norm());
        REQUIRE(bar.world.advance(0.01).ok());
    }
    CHECK(bar.world.report().momentum_error < 1e-11);
}

TEST_CASE("deformable and implicit bodies take each other's shape, and velocities but for a rigid motion", "[scene]") {
    Bar bar(Bar::one_material);
    REQUIRE(bar.world.advance(0.02).ok());
    for (const BodyDynamics next : {implicit, deformable}) {
        const auto x = bar.world.positions(bar.body), v = bar.world.velocities(bar.body);
        const std::vector<Vec3> position(x.begin(), x.end()), velocity(v.begin(), v.end());
        const Real elastic = bar.world.energy().elastic;
        REQUIRE(elastic > 0);
        bar.world.set_dynamics(bar.body, next);
        const auto now = bar.world.positions(bar.body), moving = bar.world.velocities(bar.body);
        // Point masses and the solid have different moments of inertia: equal angular momenta give unequal spins.
        const Vec3 center = bar.world.center_of_mass(bar.body);
        Vec3 change = Vec3::Zero();
        Mat3 arms = Mat3::Zero();
        for (std::size_t n = 0; n < position.size(); ++n) {
            CHECK((now[n] - position[n]).norm() < 1e-14);
            const Vec3 arm = now[n] - center;
            change += arm.cross(moving[n] - velocity[n]);
            arms += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        }
        const Vec3 turn = arms.inverse() * change;
        for (std::size_t n = 0; n < position.size(); ++n)
            CHECK((moving[n] - velocity[n] - turn.cross(now[n] - center)).norm() < 1e-9);
        CHECK(bar.world.energy().elastic == Approx(elastic).epsilon(0.02));
    }
}

TEST_CASE("an implicit body that deforms brings its elastic energy along, with losses, too", "[scene]") {
    Bar bar(Bar::one_material, {.young_modulus = 1e6, .poisson_ratio = 0.3, .density = density});
    REQUIRE(bar.world.advance(0.02).ok());  // it spins, and is stretched by the spin
    bar.world.set_dynamics(bar.body, implicit);
    const Real elastic = bar.world.energy().elastic;
    REQUIRE(elastic > 5e-5);  // J
    bar.world.set_dynamics(bar.body, deformable);
    CHECK(bar.world.energy().elastic == Approx(elastic).epsilon(0.02));
}

TEST_CASE("a body that becomes rigid is frozen in its shape, and its mesh is its rest shape when it thaws", "[scene]") {
    for (const BodyDynamics next : {deformable, implicit}) {
        CAPTURE(name_of(next));
        Bar bar(Bar::one_material);
        REQUIRE(bar.world.advance(0.02).ok());
        const auto x = bar.world.positions(bar.body);
        const std::vector<Vec3> shape(x.begin(), x.end());
        const MotionKey pose = bar.world.pose(bar.body);
        const Real mass = bar.world.mass(bar.body), elastic = bar.world.energy().elastic;
        bar.world.set_dynamics(bar.body, rigid);
        CHECK((bar.world.pose(bar.body).position - pose.position).norm() < 1e-13);
        CHECK((bar.world.pose(bar.body).rotation - pose.rotation).norm() < 1e-12);
        CHECK(bar.world.mass(bar.body) == Approx(mass).epsilon(1e-14));
        const auto frozen = bar.world.positions(bar.body);
        for (std::size_t n = 0; n < shape.size(); ++n) CHECK((frozen[n] - shape[n]).norm() < 1e-13);
        REQUIRE(bar.world.advance(0.05).ok());
        const auto moved = bar.world.positions(bar.body);
        for (std::size_t n = 1; n < shape.size(); ++n)
            CHECK((moved[n] - moved[0]).norm() == Approx((shape[n] - shape[0]).norm()).epsilon(1e-12));
        bar.world.set_material(bar.material[0],
                               lossless({.young_modulus = 1e6, .poisson_ratio = 0.3, .density = 2000}));
        CHECK(bar.world.mass(bar.body) == Approx(2 * mass).epsilon(1e-13));
        bar.world.set_material(bar.material[0],
                               lossless({.young_modulus = 1e6, .poisson_ratio = 0.3, .density = 1000}));
        bar.world.set_dynamics(bar.body, next);
        // The linear strain of an implicit body depends a little on its frame, which is fitted again.
        CHECK(bar.world.energy().elastic == Approx(elastic).epsilon(next == implicit ? 1e-4 : 1e-9));
        bar.world.reset(bar.body);
        CHECK(bar.world.energy().elastic < 1e-12);  // rounding error of E times the volume
    }
}

TEST_CASE("a body with an inverted tetrahedron is not frozen, and the number of tetrahedra is named", "[scene]") {
    Bar bar;
    const auto x = bar.world.positions(bar.body);
    std::vector<Vec3> position(x.begin(), x.end());
    Model& model = WorldAccess::state_of(bar.world).model;
    const auto first = static_cast<std::size_t>(model.bodies.nodes[model.row(bar.body, "test")].begin);
    model.nodes.position[first] += 10 * (position.back() - position.front());
    CHECK_THROWS_WITH(bar.world.set_dynamics(bar.body, rigid),
                      Catch::Contains("'bar'") && Catch::Contains("of 144 tetrahedra are flat or inverted"));
    CHECK(bar.world.dynamics(bar.body) == deformable);
}

TEST_CASE("a cube that is frozen and thawed twenty times is neither lifted nor moved", "[scene][long]") {
    for (const bool pressed : {false, true})
        for (const BodyDynamics thawed : {deformable, implicit}) {
            CAPTURE(pressed, name_of(thawed));
            World world({.threads = 1});
            const auto rubber =
                world.add_material({.young_modulus = 2e4, .poisson_ratio = 0.4, .density = 1000, .friction = 0.5});
            const auto cube =
                world.add_body(mesh::box({0.1, 0.1, 0.1}, {4, 4, 4}),
                               {.material = rubber, .position = {0, 0, 0.051}, .dynamics = thawed, .name = "cube"});
            world.add_collider(Plane{}, {.name = "floor"});
            if (pressed) {
                const auto plate =
                    world.add_collider(Box{{0.5, 0.5, 0.02}}, {.position = {0, 0, 0.115}, .name = "plate"});
                world.move_to(plate, {.position = {0, 0, 0.1}}, 0.5);
            }
            REQUIRE(world.advance(2).ok());
            const Vec3 place = world.center_of_mass(cube);
            for (int k = 0; k < 20; ++k) {
                world.set_dynamics(cube, rigid);
                REQUIRE(world.advance(0.05).ok());
                world.set_dynamics(cube, thawed);
                REQUIRE(world.advance(0.05).ok());
                // a tenth of the deflection of the centre under the weight, rho g h^2 / (4 E)
                REQUIRE((world.center_of_mass(cube) - place).norm() < 1.2e-4);
            }
        }
}

TEST_CASE("a body goes on under its handle with all that was set of it", "[scene]") {
    Bar bar;
    World& world = bar.world;
    world.set_loads(bar.body, std::vector<Vec3>(bar.mesh.nodes.size(), Vec3(0, 0, 1)));
    world.set_surface_properties(bar.body, {.friction = 0.9});
    world.set_collision_groups(bar.body, 2, 4);
    world.set_collision(bar.body, bar.ball, false);
    const Real distance = world.contact_distance(bar.body);
    const ElementKind element = world.element(bar.body);
    const Real mass = world.mass(bar.body);
    world.set_dynamics(bar.body, rigid);
    world.set_dynamics(bar.body, deformable);
    CHECK(world.name(bar.body) == "bar");
    CHECK(world.name(bar.ball) == "ball");
    CHECK(world.element(bar.body) == element);
    CHECK(world.contact_distance(bar.body) == distance);
    CHECK(world.mass(bar.body) == Approx(mass).epsilon(1e-14));
    CHECK(world.bodies() == std::vector<BodyHandle>{bar.ball, bar.body});
    world.set_collision_groups(bar.body, 1, 1);
    CHECK_FALSE(world.may_collide(bar.body, bar.ball));
    const Vec3 before = mean_velocity(world, bar.body, bar.mass);
    REQUIRE(world.advance(0.01).ok());
    const Vec3 gain = mean_velocity(world, bar.body, bar.mass) - before;
    CHECK(gain.z() == Approx(0.01 * static_cast<Real>(bar.mesh.nodes.size()) / mass).epsilon(1e-9));

    // Its elements equal those of a body added in this way: the Poisson's ratio of each material decides their kind.
    Bar other;
    CHECK(other.world.stable_step() == Approx(world.stable_step()).epsilon(0.02));
}

TEST_CASE("unsupported dynamics are refused by name, and the present dynamics change no bit", "[scene]") {
    Bar bar;
    World& world = bar.world;
    REQUIRE(world.advance(0.01).ok());
    std::uint64_t before = world.state_hash();
    world.set_dynamics(bar.body, deformable);
    CHECK(world.state_hash() == before);
    using Catch::Contains;
    CHECK_THROWS_WITH(world.set_dynamics(bar.body, BodyDynamics::automatic),
                      Contains("'bar'") && Contains("automatic"));
    const auto held = world.attach(bar.body, std::vector<Index>{0, 1, 2, 3, 4});
    before = world.state_hash();
    CHECK_THROWS_WITH(world.set_dynamics(bar.body, rigid), Contains("'bar'") && Contains("attached"));
    CHECK(world.state_hash() == before);
    world.remove(held);
    world.set_dynamics(bar.body, rigid);
    const auto joint = Joints(world).add({.kind = JointKind::ball, .first = bar.body, .point = {1, 2, 3}});
    before = world.state_hash();
    CHECK_THROWS_WITH(world.set_dynamics(bar.body, implicit), Contains("'bar'") && Contains("a body with joints"));
    CHECK(world.state_hash() == before);
    Joints(world).remove(joint);
    const Anchor on_bar{.body = bar.body, .point = world.center_of_mass(bar.body)};
    const auto spring = Springs(world).add({.first = on_bar, .stiffness = 1});
    const auto cable = Cables(world).add({.points = {{.point = {1, 2, 3}}, on_bar}, .drive = {.tension = 1}});
    CHECK_THROWS_WITH(world.set_dynamics(bar.body, implicit), Contains("a body with cables and springs") &&
                                                                  Contains("remove the cables and springs") &&
                                                                  !Contains("joints or springs"));
    Springs(world).remove(spring);
    Cables(world).remove(cable);
    world.set_dynamics(bar.body, implicit);
    const auto curled = world.add_body(bar.mesh, {.material = bar.material[0], .self_contact = true, .name = "curled"});
    CHECK_THROWS_WITH(world.set_dynamics(curled, rigid), Contains("'curled'") && Contains("self_contact"));
    world.remove(bar.body);
    CHECK_THROWS_WITH(world.set_dynamics(bar.body, rigid), Contains("set_dynamics"));
}

TEST_CASE("a body that becomes rigid in a stack carries and is carried, without an overlap at any step", "[scene]") {
    Stack stack;
    World& world = stack.world;
    REQUIRE(world.advance(0.5).ok());
    for (const auto& [which, next] : {std::pair{0, rigid}, {1, implicit}, {0, deformable}, {1, rigid}, {0, implicit}}) {
        world.set_dynamics(stack.block[static_cast<std::size_t>(which)], next);
        REQUIRE(world.advance(0.3).ok());
        CHECK(stack.lowest(0) > 0);
        CHECK(stack.lowest(1) > 0.098);
        CHECK(stack.lowest(1) < 0.104);
        CHECK(world.center_of_mass(stack.block[1]).head<2>().norm() < 1e-3);
    }
}

TEST_CASE("a world in which bodies changed their kind continues bitwise, on any number of threads and from a file",
          "[determinism]") {
    const auto simulate = [](int threads) {
        Bar bar(Bar::two_materials, {.young_modulus = 1e6, .poisson_ratio = 0.3, .density = density}, threads,
                {0, 0, -standard_gravity});
        bar.world.add_collider(Plane{.point = {0, 0, 2.8}});
        REQUIRE(bar.world.advance(0.05).ok());
        bar.world.set_dynamics(bar.body, implicit);
        REQUIRE(bar.world.advance(0.05).ok());
        bar.world.set_dynamics(bar.body, deformable);
        return bar;
    };
    check_same_bits(simulate, [](World& world) {
        const BodyHandle body = world.bodies().back();
        world.set_dynamics(body, rigid);
        REQUIRE(world.advance(0.05).ok());
        world.set_dynamics(body, deformable);
        REQUIRE(world.advance(0.05).ok());
    });
}

}  // namespace skerry::test::dynamics_test
