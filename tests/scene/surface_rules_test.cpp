// Friction by pair of materials and by place, in whole steps, against closed forms (docs/methods/friction.md 4).
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "skerry/surface.h"
#include "systems/collision/build_surface.h"
#include "tests/support/mapped_box.h"
#include "tests/support/message_of.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::surface_rules_test {

namespace {

constexpr Real g = standard_gravity;
constexpr Real degree = std::numbers::pi / 180;

/// Numbers of the nodes of a mesh for which `chosen` is true.
Settings with_step(const Vec3& gravity, Real h = 1.0 / 500) {
    Settings settings = accurate(gravity, 1e-11);
    settings.step_size = h;
    return settings;
}

const Mesh block = mesh::box({0.1, 0.1, 0.05}, {2, 2, 1});

BodySettings placed(MaterialHandle material, const Vec3& position, BodyDynamics dynamics = BodyDynamics::rigid) {
    return {.material = material, .position = position, .contact_distance = 0, .dynamics = dynamics};
}

Vec3 horizontal(const Vec3& v) {
    return {v.x(), v.y(), 0};
}

/// Gravity on an incline of the angle `slope` whose downhill direction has the angle `heading` with the x axis [rad].
Vec3 incline(Real slope, Real heading) {
    return g * Vec3(std::sin(slope) * std::cos(heading), std::sin(slope) * std::sin(heading), -std::cos(slope));
}

/// A block whose friction depends on the direction: `along` in the x direction of its mesh, `across` in y.
struct SkiBlock {
    World world;
    BodyHandle body;
    SurfaceSetHandle set;

    SkiBlock(const Settings& settings, Real along, Real across, BodyDynamics dynamics = BodyDynamics::rigid,
             Real turned = 0, const MaterialSettings& material_settings = {})
        : world(settings) {
        const auto material = world.add_material(material_settings);
        world.add_collider(Plane{});
        BodySettings place = placed(material, {0, 0, 0.025}, dynamics);
        place.rotation = {0, 0, turned};
        body = world.add_body(block, place);
        const std::vector<Index> bottom = nodes_where(block, [](const Vec3& x) { return x.z() < -0.02; });
        set = SurfaceSets(world).add({.body = body,
                                      .nodes = bottom,
                                      .surface = {.friction = along},
                                      .friction_across = across,
                                      .direction = Vec3(1, 0, 0)});
    }
};

}  // namespace

TEST_CASE("three blocks on one incline each hold to a tenth of a degree of their own angle", "[scene][surface]") {
    // Rubber and wood have their own values on steel; for ice the geometric mean of 0.04 and 0.36 applies.
    constexpr Real of_rubber = 0.8, of_wood = 0.3, of_ice = 0.12;
    for (const Real limit : {of_rubber, of_wood, of_ice})
        for (const Real beside : {-0.1, 0.1}) {
            const Real slope = std::atan(limit) + beside * degree;
            World world(with_step(tilted_gravity(slope / degree)));
            const auto steel = world.add_material({.friction = 0.36}), rubber = world.add_material({.friction = 0.9}),
                       wood = world.add_material({.friction = 0.5}), ice = world.add_material({.friction = 0.04});
            SurfacePairs pairs(world);
            pairs.set_material(world.add_collider(Plane{}), steel);
            pairs.set(rubber, steel, {.friction = of_rubber});
            pairs.set(steel, wood, {.static_friction = of_wood, .dynamic_friction = of_wood});
            std::vector<BodyHandle> blocks;
            for (const auto material : {rubber, wood, ice})
                blocks.push_back(world.add_body(block, placed(material, {0, static_cast<Real>(blocks.size()), 0.025})));
            REQUIRE(world.advance(0.1).ok());
            std::vector<Vec3> start, speed;
            for (const BodyHandle body : blocks) {
                start.push_back(world.center_of_mass(body));
                speed.push_back(world.velocity(body).velocity);
            }
            REQUIRE(world.advance(0.1).ok());
            const std::vector<Real> mu{of_rubber, of_wood, of_ice};
            for (std::size_t b = 0; b < blocks.size(); ++b) {
                const Real slip = (world.center_of_mass(blocks[b]) - start[b]).norm();
                if (std::tan(slope) <= mu[b]) {
                    CHECK(slip < 1e-9);
                } else {
                    const Real gain = (world.velocity(blocks[b]).velocity - speed[b]).norm() / 0.1;
                    CHECK(gain == Approx(g * (std::sin(slope) - mu[b] * std::cos(slope))).epsilon(1e-3));
                }
            }
            for (const Contact& contact : world.contacts()) {
                const auto b = static_cast<std::size_t>(std::ranges::find(blocks, contact.first) - blocks.begin());
                REQUIRE(b < 3);
                CHECK(contact.static_friction == Approx(mu[b]).epsilon(1e-12));
                CHECK(contact.dynamic_friction == Approx(mu[b]).epsilon(1e-12));
                CHECK(contact.friction_direction == Vec3::Zero());
            }
        }
}

TEST_CASE("the order of a pair of materials does not matter, for bodies of every dynamics", "[scene][surface]") {
    for (const BodyDynamics dynamics :
         {BodyDynamics::rigid, BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        std::vector<std::uint64_t> hashes;
        std::vector<Real> gained;
        for (const bool swapped : {false, true}) {
            Settings settings = with_step(tilted_gravity(20));
            settings.step_size.reset();
            World world(settings);
            const auto a = world.add_material({.young_modulus = 1e6, .friction = 0.9}),
                       b = world.add_material({.young_modulus = 1e6, .friction = 0.9});
            world.add_collider(Plane{});
            const auto below = world.add_body(mesh::box({0.3, 0.2, 0.05}, {3, 2, 1}),
                                              placed(a, {0, 0, 0.025}, BodyDynamics::rigid)),
                       above = world.add_body(block, placed(b, {0, 0, 0.075}, dynamics));
            SurfacePairs(world).set(swapped ? b : a, swapped ? a : b, {.friction = 0.2});
            const auto speed = [&] { return (world.velocity(above).velocity - world.velocity(below).velocity).x(); };
            REQUIRE(world.advance(0.1).ok());
            const Real before = speed();
            REQUIRE(world.advance(0.1).ok());
            hashes.push_back(world.state_hash());
            gained.push_back(speed() - before);
        }
        CHECK(hashes[0] == hashes[1]);
        CAPTURE(name_of(dynamics));
        CHECK(gained[0] == Approx(0.1 * g * (std::sin(20 * degree) - 0.2 * std::cos(20 * degree))).epsilon(0.01));
    }
}

TEST_CASE("a sliding plate that is half rubber and half ice turns about its centre of percussion", "[scene][surface]") {
    // Friction acts at the corners of the rubber half, at the distance a from the centre. The velocity of the point
    // I/(m a) beyond the centre then does not change.
    constexpr Real width = 0.2, depth = 0.1, speed = 20;
    const Mesh plate = mesh::box({width, depth, 0.002}, {1, 1, 1});
    for (const bool by_faces : {false, true}) {
        World world(with_step({0, 0, -g}, 1.0 / 2000));
        const auto material = world.add_material({.friction = 0});
        world.add_collider(Plane{});
        BodySettings place = placed(material, {0, 0, 0.001});
        place.velocity = {0, speed, 0};
        const auto body = world.add_body(plate, place);
        SurfaceSetSettings rubber{.body = body, .surface = {.friction = 0.7}};
        if (by_faces) {
            for (const BoundaryTriangle& face : boundary_triangles(plate.tetrahedra))
                if (std::ranges::all_of(face.node, [&](Index n) { return plate.nodes[n].x() < 0; }))
                    rubber.faces.push_back({face.node[2], face.node[0], face.node[1]});
            REQUIRE(rubber.faces.size() == 2);
        } else {
            rubber.nodes = nodes_where(plate, [](const Vec3& x) { return x.x() < 0; });
        }
        SurfaceSets(world).add(rubber);
        constexpr Real time = 0.02;
        REQUIRE(world.advance(time).ok());
        const Twist twist = world.velocity(body);
        const Real arm = width / 2, expected = (width * width + depth * depth) / 12 / arm;
        const Real lost = speed - twist.velocity.y();
        CHECK(lost == Approx(0.7 * g / 2 * time).epsilon(2e-3));
        CHECK(lost / twist.angular_velocity.z() == Approx(expected).epsilon(5e-3));
        Index rubber_contacts = 0;
        for (const Contact& contact : world.contacts()) {
            if (contact.impulse.isZero(0)) continue;
            const bool left = plate.nodes[contact.node[0]].x() < 0;
            CHECK(contact.dynamic_friction == Approx(left ? 0.7 : 0).margin(1e-15));
            rubber_contacts += left;
        }
        CHECK(rubber_contacts == 2);
    }
}

TEST_CASE("friction with two coefficients holds up to the ellipse, whatever the downhill direction",
          "[scene][surface][long]") {
    constexpr Real along = 0.6, across = 0.2;
    for (const Real dynamic : {1.0, 0.75})  // as a multiple of static friction, in both directions
        for (const Real heading : {0.0, 25 * degree, 60 * degree, 90 * degree}) {
            const Real critical = std::atan(1 / std::hypot(std::cos(heading) / along, std::sin(heading) / across));
            // With two coefficients, a contact that reaches its limit before the others slides and loads them more.
            for (const Real beside : {dynamic < 1 ? -3 : -0.1, 0.1}) {
                SkiBlock ski(with_step(incline(critical + beside * degree, heading)), along, across);
                SurfaceSets(ski.world).set_surface(
                    ski.set, {.static_friction = along, .dynamic_friction = dynamic * along}, dynamic * across);
                REQUIRE(ski.world.advance(0.1).ok());
                const Vec3 start = ski.world.center_of_mass(ski.body);
                REQUIRE(ski.world.advance(0.1).ok());
                const Real slip = (ski.world.center_of_mass(ski.body) - start).norm();
                CAPTURE(dynamic, heading, beside, slip);
                CHECK((beside < 0 ? slip < 1e-9 : slip > 1e-6));
            }
        }
}

TEST_CASE("a block slides off an incline in the direction of the elliptic friction law", "[scene][surface]") {
    // Friction on the sliding block is -N C v / sqrt(v . C v), C = diag(along^2, across^2): it is normal to v in the
    // metric of the ellipse. From rest, acceleration and velocity have the same direction beta:
    // (tan s sin a - C_y sin b / e) cos b = (tan s cos a - C_x cos b / e) sin b, e = sqrt(C_x cos^2 b + C_y sin^2 b).
    // Just above the critical slope this becomes tan b = (along/across)^2 tan a.
    constexpr Real along = 0.5, across = 0.25;
    struct Case {
        Real heading, steeper;
        BodyDynamics dynamics;
        Real turned = 0;
        SolverMethod method = SolverMethod::automatic;
    };
    for (const Case& now :
         {Case{40 * degree, 0.2 * degree, BodyDynamics::rigid}, Case{40 * degree, 10 * degree, BodyDynamics::rigid},
          Case{70 * degree, 10 * degree, BodyDynamics::rigid}, Case{40 * degree, 10 * degree, BodyDynamics::rigid, 0.5},
          Case{40 * degree, 10 * degree, BodyDynamics::rigid, 0.5, SolverMethod::ags},
          Case{40 * degree, 10 * degree, BodyDynamics::rigid, 0.5, SolverMethod::pcg_pgs},
          Case{40 * degree, 10 * degree, BodyDynamics::explicit_elastic},
          Case{40 * degree, 10 * degree, BodyDynamics::explicit_elastic, 0.5},
          Case{40 * degree, 10 * degree, BodyDynamics::implicit_elastic}}) {
        const Real critical = std::atan(1 / std::hypot(std::cos(now.heading) / along, std::sin(now.heading) / across));
        const Real steep = std::tan(critical + now.steeper);
        const auto excess = [&](Real b) {
            const Real e = std::hypot(along * std::cos(b), across * std::sin(b));
            return (steep * std::sin(now.heading) - across * across * std::sin(b) / e) * std::cos(b) -
                   (steep * std::cos(now.heading) - along * along * std::cos(b) / e) * std::sin(b);
        };
        Real low = now.heading, high = 90 * degree;
        for (int i = 0; i < 60; ++i) (excess((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
        const bool limit = now.steeper < degree;
        if (limit)
            CHECK(low == Approx(std::atan(along * along / (across * across) * std::tan(now.heading))).epsilon(0.005));
        Settings settings = with_step(incline(critical + now.steeper, now.heading + now.turned), 1.0 / 1000);
        settings.method = now.method;
        const bool deforms = now.dynamics == BodyDynamics::explicit_elastic;
        if (deforms) settings.step_size.reset();
        SkiBlock ski(settings, along, across, now.dynamics, now.turned, {.young_modulus = 2e6, .damping = 200});
        REQUIRE(ski.world.advance(0.05).ok());
        const Vec3 before = ski.world.velocity(ski.body).velocity;
        REQUIRE(ski.world.advance(0.3).ok());
        const Vec3 gained = horizontal(ski.world.velocity(ski.body).velocity - before);
        const Real beta = std::atan2(gained.y(), gained.x()) - now.turned;
        CHECK(beta == Approx(low).epsilon(0.005));
        for (const Contact& contact : ski.world.contacts()) {
            if (contact.impulse.isZero(0)) continue;
            CHECK(contact.motion == ContactMotion::slide);
            CHECK(contact.dynamic_friction == Approx(along).epsilon(1e-12));
            CHECK(contact.friction_across == Approx(across).epsilon(1e-12));
            CHECK(std::abs(contact.friction_direction.dot(Vec3(std::cos(now.turned), std::sin(now.turned), 0))) ==
                  Approx(1).epsilon(1e-3));
        }
    }
}

TEST_CASE("friction with two coefficients does not depend on the step, and never gives energy", "[scene][surface]") {
    std::vector<Vec3> end;
    for (const Real h : {1e-3, 1e-4}) {
        SkiBlock ski(with_step({0, 0, -g}, h), 0.4, 0.1);
        ski.world.set_velocity(ski.body, {0.7, 0.5, 0});
        REQUIRE(ski.world.advance(0.1).ok());
        const Energy energy = ski.world.energy();
        const Real mass = 1000 * 0.1 * 0.1 * 0.05;
        const Real start = mass * (0.5 * (0.49 + 0.25) + g * 0.025);
        CHECK(energy.kinetic + energy.potential + energy.dissipated == Approx(start).epsilon(1e-9));
        CHECK(energy.dissipated > 0);
        end.push_back(ski.world.velocity(ski.body).velocity);
    }
    CHECK((end[0] - end[1]).norm() < 1e-3 * end[1].norm());
}

TEST_CASE("worlds with pairs and surface sets keep their bits", "[scene][surface]") {
    struct Course {
        World world;
        explicit Course(Index threads)
            : world([&] {
                  Settings settings = with_step(incline(30 * degree, 0.7));
                  settings.step_size.reset();
                  settings.threads = threads;
                  return settings;
              }()) {
            const auto soft = world.add_material({.young_modulus = 1e6}), steel = world.add_material({});
            SurfacePairs pairs(world);
            pairs.set_material(world.add_collider(Plane{}), steel);
            pairs.set(soft, steel, {.friction = 0.3, .restitution = 0.1});
            for (int k = 0; k < 3; ++k) {
                const auto body = world.add_body(
                    block, placed(soft, {0.2 * k, 0, 0.03},
                                  k == 2 ? BodyDynamics::implicit_elastic : BodyDynamics::explicit_elastic));
                if (k > 0)
                    SurfaceSets(world).add({.body = body,
                                            .nodes = nodes_where(block, [](const Vec3& x) { return x.x() < 0.01; }),
                                            .surface = {.friction = 0.4},
                                            .friction_across = 0.1,
                                            .direction = Vec3(1, 0.5, 0)});
            }
            REQUIRE(world.advance(0.02).ok());
        }
    };
    check_same_bits([](Index threads) { return Course(threads); },
                    [](World& world) { REQUIRE(world.advance(0.02).ok()); });
    Course course(1);
    const std::uint64_t before = course.world.state_hash();
    const SurfaceSetHandle set = SurfaceSets(course.world).all()[0];
    SurfaceSets(course.world).set_surface(set, {.friction = 0.41}, 0.1);
    CHECK(course.world.state_hash() != before);
    SurfaceSets(course.world).set_surface(set, {.friction = 0.4}, 0.1);
    CHECK(course.world.state_hash() == before);
    const auto materials = course.world.materials();
    SurfacePairs(course.world).set(materials[0], materials[1], {.friction = 0.31, .restitution = 0.1});
    CHECK(course.world.state_hash() != before);
}

TEST_CASE("the state hash shows which of two overlapping surface sets is the later one", "[scene][surface]") {
    std::vector<std::uint64_t> hashes;
    for (const bool rubber_first : {true, false}) {
        World world;
        const auto body = world.add_body(block, {.material = world.add_material({})});
        const SurfaceSetSettings rubber{
            .body = body, .nodes = nodes_where(block, [](const Vec3&) { return true; }), .surface = {.friction = 0.9}};
        SurfaceSetSettings ice = rubber;
        ice.surface.friction = 0.1;
        SurfaceSets sets(world);
        // In both worlds rubber has the first slot. In the second world this slot becomes free, and is used again.
        const SurfaceSetHandle first = sets.add(rubber);
        sets.add(ice);
        if (!rubber_first) {
            sets.remove(first);
            sets.add(rubber);
        }
        hashes.push_back(world.state_hash());
    }
    CHECK(hashes[0] != hashes[1]);
}

TEST_CASE("a sleeping block on an incline wakes when its friction falls", "[scene][surface]") {
    for (const bool by_pair : {true, false}) {
        Settings settings = with_step(tilted_gravity(15));
        settings.sleep = true;
        World world(settings);
        const auto wood = world.add_material({.friction = 0.5}), steel = world.add_material({.friction = 0.5});
        SurfacePairs pairs(world);
        pairs.set_material(world.add_collider(Plane{}), steel);
        const auto body = world.add_body(block, placed(wood, {0, 0, 0.025}));
        SurfaceSets sets(world);
        SurfaceSetHandle set;
        if (by_pair)
            pairs.set(wood, steel, {.friction = 0.5});
        else
            set = sets.add({.body = body,
                            .nodes = nodes_where(block, [](const Vec3& x) { return x.z() < 0; }),
                            .surface = {.friction = 0.5}});
        for (int k = 0; k < 100 && !world.asleep(body); ++k) REQUIRE(world.advance(0.1).ok());
        REQUIRE(world.asleep(body));
        const Vec3 start = world.center_of_mass(body);
        if (by_pair)
            pairs.set(steel, wood, {.friction = 0.1});
        else
            sets.set_surface(set, {.friction = 0.02});  // with the 0.5 of steel: 0.1
        CHECK(!world.asleep(body));
        REQUIRE(world.advance(0.5).ok());
        const Real gain = g * (std::sin(15 * degree) - 0.1 * std::cos(15 * degree));
        CHECK((world.center_of_mass(body) - start).norm() == Approx(0.5 * gain * 0.25).epsilon(0.01));
        if (by_pair)
            pairs.remove(wood, steel);
        else
            sets.remove(set);
        REQUIRE(world.advance(1e-2).ok());
        for (const Contact& contact : world.contacts()) CHECK(contact.dynamic_friction == Approx(0.5));
    }
}

TEST_CASE("a surface set goes with its body, and follows it when other bodies are removed", "[scene][surface]") {
    World world(with_step({0, 0, -g}));
    const auto material = world.add_material({.friction = 0.5});
    world.add_collider(Plane{});
    std::vector<BodyHandle> bodies;
    std::vector<SurfaceSetHandle> handles;
    SurfaceSets sets(world);
    for (int k = 0; k < 3; ++k) {
        bodies.push_back(world.add_body(block, placed(material, {0.3 * k, 0, 0.025})));
        handles.push_back(sets.add({.body = bodies.back(),
                                    .nodes = nodes_where(block, [](const Vec3& x) { return x.z() < 0; }),
                                    .surface = {.friction = 0.1 * (k + 1)}}));
    }
    REQUIRE(world.advance(0.01).ok());
    world.remove(bodies[0]);
    CHECK(!sets.alive(handles[0]));
    CHECK(sets.all().size() == 2);
    REQUIRE(world.advance(0.01).ok());
    REQUIRE(!world.contacts().empty());
    for (const Contact& contact : world.contacts())
        CHECK(contact.dynamic_friction == Approx(contact.first == bodies[1] ? 0.2 : 0.3));
    const SurfaceSetSettings kept = sets.settings(handles[2]);
    CHECK(kept.body == bodies[2]);
    CHECK(kept.nodes == nodes_where(block, [](const Vec3& x) { return x.z() < 0; }));
    CHECK(kept.surface.friction == 0.1 * 3);
}

TEST_CASE("a surface set stays with a body whose dynamics change", "[scene][surface]") {
    SkiBlock ski(with_step({0, 0, -g}), 0.4, 0.1, BodyDynamics::explicit_elastic);
    REQUIRE(ski.world.advance(0.01).ok());
    for (const BodyDynamics next : {BodyDynamics::rigid, BodyDynamics::implicit_elastic}) {
        ski.world.set_dynamics(ski.body, next);
        REQUIRE(ski.world.advance(0.01).ok());
        CHECK(SurfaceSets(ski.world).settings(ski.set).body == ski.body);
        REQUIRE(!ski.world.contacts().empty());
        for (const Contact& contact : ski.world.contacts())
            if (!contact.impulse.isZero(0)) CHECK(contact.friction_across == Approx(0.1));
    }
}

TEST_CASE("invalid surface rules are refused", "[scene][surface]") {
    World world(Settings{});
    const auto material = world.add_material({});
    const auto body = world.add_body(block, {.material = material, .name = "sledge"});
    const auto ball = world.add_body(Sphere{0.1}, {.material = material, .position = {1, 0, 0}, .name = "ball"});
    SurfaceSets sets(world);
    const std::vector<Index> node{0};
    const auto refusal = [&](const SurfaceSetSettings& set) { return message_of([&] { sets.add(set); }); };
    using Catch::Matchers::Contains;
    const std::optional<Vec3> x(Vec3(1, 0, 0));
    CHECK_THAT(refusal({.body = body}), Contains("sledge") && Contains("no node and no face"));
    CHECK_THAT(refusal({.body = ball, .nodes = node}), Contains("ball") && Contains("a sphere"));
    CHECK_THAT(refusal({.body = body, .nodes = {999}}), Contains("999"));
    CHECK_THAT(refusal({.body = body, .nodes = {3, 0, 3}}), Contains("node 3 twice"));
    std::array<Index, 3> face = world.surface(body)[0];
    SurfaceSetSettings repeated{.body = body, .faces = {face}};
    std::ranges::reverse(face);
    repeated.faces.push_back(face);
    CHECK_THAT(refusal(repeated), Contains("faces[1]") && Contains("each face at most once"));
    CHECK_THAT(refusal({.body = body, .faces = {{0, 1, 17}}}), Contains("faces[0]") && Contains("0, 1, 17"));
    CHECK_THAT(refusal({.body = body, .nodes = node, .surface = {.friction = -1}}), Contains("friction"));
    CHECK_THAT(refusal({.body = body, .nodes = node, .surface = {.friction = 1}, .friction_across = 0.5}),
               Contains("friction_across") && Contains("direction"));
    CHECK_THAT(refusal({.body = body, .nodes = node, .friction_across = 0.5, .direction = x}),
               Contains("friction") && Contains("no value"));
    CHECK_THAT(refusal({.body = body, .nodes = node, .surface = {.friction = 1}, .friction_across = 0, .direction = x}),
               Contains("friction_across"));
    CHECK_THAT(refusal({.body = body, .nodes = node, .direction = Vec3(Vec3::Zero())}), Contains("direction"));
    CHECK(sets.all().empty());
    CHECK_THROWS_AS(SurfacePairs(world).set(material, MaterialHandle{}, {.friction = 1}), SceneError);
    CHECK_THROWS_AS(SurfacePairs(world).set(material, material, {.restitution = 2}), SceneError);
    CHECK(SurfacePairs(world).all().empty());
}

}  // namespace skerry::test::surface_rules_test
