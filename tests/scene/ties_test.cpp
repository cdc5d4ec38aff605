// Ties in whole steps, against closed forms (docs/methods/ties.md).
#include "skerry/tie.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "skerry/joint.h"
#include "tests/support/frequency.h"
#include "tests/support/same_bits.h"
#include "tests/support/worlds.h"

namespace skerry::test::ties_test {

namespace {

constexpr Real side = 0.1, half = 0.2;  // width and half of the length of a bar along x [m]

/// Numbers of the nodes of a mesh whose coordinate x is `x`.
std::vector<Index> nodes_at(const Mesh& mesh, Real x) {
    std::vector<Index> found;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (std::abs(mesh.nodes[n].x() - x) < 1e-9) found.push_back(static_cast<Index>(n));
    return found;
}

Settings without_gravity(Real tolerance = 1e-10) {
    return accurate(Vec3::Zero(), tolerance);
}

const Mesh coarse = mesh::box({half, side, side}, {4, 2, 2}), fine = mesh::box({half, side, side}, {6, 3, 3});
constexpr MaterialSettings rubber{.young_modulus = 1e6, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0};

/// Two halves of a bar, whose meshes do not match. The fine one is tied to the coarse one.
struct TwoHalves {
    World world;
    BodyHandle left, right;
    TieHandle tie;
    std::vector<Index> tied = nodes_at(fine, -half / 2);

    explicit TwoHalves(const Settings& settings = without_gravity(), const TieSettings& with = {},
                       BodyDynamics of_left = BodyDynamics::explicit_elastic,
                       BodyDynamics of_right = BodyDynamics::explicit_elastic, const MaterialSettings& material = rubber)
        : world(settings) {
        const MaterialHandle of = world.add_material(material);
        const auto add = [&](const Mesh& mesh, Real x, BodyDynamics dynamics) {
            return world.add_body(mesh, {.material = of, .position = {x, 0, 0}, .dynamics = dynamics});
        };
        left = add(coarse, -half / 2, of_left);
        right = add(fine, half / 2, of_right);
        TieSettings tie_settings = with;
        tie_settings.body = right;
        tie_settings.nodes = tied;
        tie_settings.to_body = left;
        tie = Ties(world).add(tie_settings);
    }
};

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // angular: about the origin
};

Momenta momenta(const World& world, BodyHandle body, const Mesh& mesh, Real density = 1000) {
    const std::vector<Real> mass = node_masses(world, body, mesh, density);
    Momenta sum;
    for (std::size_t n = 0; n < mass.size(); ++n) {
        const Vec3 momentum = mass[n] * world.velocities(body)[n];
        sum.linear += momentum;
        sum.angular += world.positions(body)[n].cross(momentum);
    }
    return sum;
}

Momenta operator+(const Momenta& a, const Momenta& b) {
    return {a.linear + b.linear, a.angular + b.angular};
}

}  // namespace

TEST_CASE("two tied halves conserve momentum and angular momentum", "[scene][ties]") {
    TwoHalves bar;
    bar.world.set_velocity(bar.left, {0.3, 0.2, -0.1}, {1, 2, 3});
    bar.world.set_velocity(bar.right, {-0.3, 0.1, 0.2}, {-2, 1, 4});
    const auto sum = [&] { return momenta(bar.world, bar.left, coarse) + momenta(bar.world, bar.right, fine); };
    const Momenta before = sum();
    REQUIRE(bar.world.advance(0.05).ok());
    const Momenta after = sum();
    CHECK((after.linear - before.linear).norm() < 1e-12);
    CHECK((after.angular - before.angular).norm() < 1e-12);
    const TieState state = Ties(bar.world).state(bar.tie);
    CHECK(state.error < 1e-9);
    CHECK(state.force.norm() > 0);
    CHECK(bar.world.report().energy_error_share < 1e-3);
    CHECK(bar.world.report().momentum_error_share < 1e-12);
}

TEST_CASE("a tie stays exact for ten thousand steps", "[scene][ties]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        Settings settings = without_gravity(1e-6);
        TwoHalves bar(settings, {}, dynamics);
        bar.world.set_velocity(bar.left, Vec3::Zero(), {0, 0, 3});
        const Real h = bar.world.stable_step();
        Real worst = 0;
        for (int k = 0; k < 100; ++k) {
            REQUIRE(bar.world.advance(20 * h).ok());
            worst = std::max(worst, Ties(bar.world).state(bar.tie).error);
        }
        CAPTURE(static_cast<int>(dynamics));
        CHECK(worst < 1e-9 * half);
        CHECK(bar.world.report().energy_error_share < 0.01);
    }
}

TEST_CASE("a node breaks off at its greatest force", "[scene][ties]") {
    constexpr Real limit = 2, rate = 10;  // [N], [N/s]
    Settings settings = without_gravity();
    World world(settings);
    const MaterialHandle of = world.add_material(rubber);
    const Mesh cube = mesh::box({side, side, side}, {1, 1, 1});
    const BodyHandle body = world.add_body(cube, {.material = of, .dynamics = BodyDynamics::implicit_elastic});
    Ties ties(world);
    const TieHandle tie = ties.add({.body = body, .nodes = {0}, .break_force = limit});
    Real most = 0;
    const Real h = 1e-4;
    while (!ties.state(tie).nodes[0].broken && world.time() < 1) {
        std::vector<Vec3> load(cube.nodes.size(), Vec3::Zero());
        load[0] = {rate * world.time(), 0, 0};
        world.set_loads(body, load);
        REQUIRE(world.advance(h).ok());
        most = std::max(most, ties.state(tie).force.norm());
    }
    const TieState broken = ties.state(tie);
    REQUIRE(broken.nodes[0].broken);
    CHECK(*broken.nodes[0].broken == Approx(limit / rate).epsilon(1e-3));
    CHECK(*broken.nodes[0].broken == world.time());
    CHECK(most == Approx(limit).epsilon(1e-3));
    REQUIRE(world.advance(h).ok());
    CHECK(ties.state(tie).force == Vec3::Zero());
    CHECK(world.center_of_mass(body).x() > 0);
}

TEST_CASE("a tie follows a moving collider and keeps its bodies awake", "[scene][ties]") {
    Settings settings = accurate();
    settings.sleep = true;
    settings.sleep_time = 0.05;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        World world(settings);
        const MaterialHandle of = world.add_material({.young_modulus = 1e6, .damping = 50});
        const ColliderHandle box = world.add_collider(Box{{side, side, side}}, {.position = {0, 0, side + 0.02}});
        const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});
        const BodyHandle body = world.add_body(cube, {.material = of, .dynamics = dynamics});
        std::vector<Index> top;
        for (std::size_t n = 0; n < cube.nodes.size(); ++n)
            if (cube.nodes[n].z() > 0.049) top.push_back(static_cast<Index>(n));
        Ties ties(world);
        const TieHandle tie = ties.add({.body = body, .nodes = top, .to_collider = box});
        REQUIRE(world.advance(2).ok());
        CHECK(world.asleep(body));
        CHECK(ties.state(tie).force.z() == Approx(9.81).epsilon(1e-2));
        world.set_velocity(box, {0.2, 0, 0}, {0, 0, 1});
        REQUIRE(world.advance(1).ok());
        CHECK_FALSE(world.asleep(body));
        CHECK(ties.state(tie).error < 1e-7);
        const Vec3 expected = Vec3(0.2, 0, 0);
        CHECK((world.center_of_mass(body).head<2>() - expected.head<2>()).norm() < 2e-3);
    }
}

namespace {

/// Tetrahedra of a mesh on one side of x = 0.
Mesh part_of(const Mesh& whole, bool right) {
    Mesh part;
    std::vector<Index> now(whole.nodes.size(), -1);
    for (const auto& t : whole.tetrahedra) {
        Real x = 0;
        for (const Index n : t) x += whole.nodes[static_cast<std::size_t>(n)].x() / 4;
        if ((x > 0) != right) continue;
        auto& corners = part.tetrahedra.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) {
            Index& row = now[static_cast<std::size_t>(t[k])];
            if (row < 0) {
                row = static_cast<Index>(part.nodes.size());
                part.nodes.push_back(whole.nodes[static_cast<std::size_t>(t[k])]);
            }
            corners[k] = row;
        }
    }
    return part;
}

}  // namespace

TEST_CASE("two halves with matching meshes move like the whole bar", "[scene][ties]") {
    Settings settings = without_gravity(1e-12);
    settings.step_size = 2e-5;
    settings.clusters = false;
    const Mesh mesh = mesh::box({2 * half, side, side}, {8, 2, 2});
    const std::array<Mesh, 2> part{part_of(mesh, false), part_of(mesh, true)};
    World whole(settings), tied(settings);
    const auto add = [&](World& world, const Mesh& of) {
        return world.add_body(of, {.material = world.add_material(rubber),
                                   .dynamics = BodyDynamics::explicit_elastic,
                                   .element = ElementKind::linear});
    };
    const BodyHandle bar = add(whole, mesh);
    const std::array<BodyHandle, 2> body{add(tied, part[0]), add(tied, part[1])};
    const TieHandle tie = Ties(tied).add({.body = body[1], .nodes = nodes_at(part[1], 0), .to_body = body[0]});
    // all modes at once: stretching, bending and twisting
    const auto velocity = [](const Vec3& x) {
        return Vec3(0.1 * std::sin(8 * x.x()), 0.2 * std::cos(9 * x.x()) + x.x() * x.z(), -x.x() * x.y());
    };
    const auto start = [&](World& world, BodyHandle of, const Mesh& nodes) {
        std::vector<Vec3> v;
        for (const Vec3& x : nodes.nodes) v.push_back(velocity(x));
        world.set_velocities(of, v);
    };
    start(whole, bar, mesh);
    start(tied, body[0], part[0]);
    start(tied, body[1], part[1]);
    REQUIRE(whole.advance(0.03).ok());
    REQUIRE(tied.advance(0.03).ok());
    Real worst = 0, moved = 0;
    for (std::size_t side_of = 0; side_of < 2; ++side_of)
        for (std::size_t n = 0; n < part[side_of].nodes.size(); ++n) {
            const Vec3& x = part[side_of].nodes[n];
            for (std::size_t m = 0; m < mesh.nodes.size(); ++m) {
                if (mesh.nodes[m] != x) continue;
                worst = std::max(worst, (tied.positions(body[side_of])[n] - whole.positions(bar)[m]).norm());
                moved = std::max(moved, (whole.positions(bar)[m] - x).norm());
            }
        }
    CHECK(moved > 1e-3);
    CHECK(worst < 1e-8 * moved);
    CHECK(Ties(tied).state(tie).error < 1e-12);
}

TEST_CASE("two halves with meshes that do not match have the frequencies of the whole bar", "[scene][ties]") {
    Settings settings = without_gravity(1e-8);
    settings.step_size = 2e-5;
    // Natural frequencies of longitudinal vibration, by the shapes cos(k pi x / L) about the left end.
    const auto frequencies = [&](World& world, const std::vector<std::pair<BodyHandle, const Mesh*>>& parts, int k) {
        const auto shape = [&](Real x) { return std::cos(k * std::numbers::pi * (x + half) / (2 * half)); };
        std::vector<std::vector<Real>> weight;
        for (const auto& [body, mesh] : parts) {
            std::vector<Vec3> v;
            weight.emplace_back();
            const std::vector<Real> mass = node_masses(world, body, *mesh, 1000);
            for (std::size_t n = 0; n < mass.size(); ++n) {
                const Real at = shape(world.positions(body)[n].x());
                v.push_back({0.01 * at, 0, 0});
                weight.back().push_back(mass[n] * at);
            }
            world.set_velocities(body, v);
        }
        std::vector<Real> sample;
        for (int i = 0; i < 2000; ++i) {
            REQUIRE(world.advance(settings.step_size.value()).ok());
            Real sum = 0;
            for (std::size_t b = 0; b < parts.size(); ++b)
                for (std::size_t n = 0; n < weight[b].size(); ++n)
                    sum += weight[b][n] * world.velocities(parts[b].first)[n].x();
            sample.push_back(sum);
        }
        return angular_frequency(sample, *settings.step_size);
    };
    const Mesh whole_coarse = mesh::box({2 * half, side, side}, {8, 2, 2}),
               whole_fine = mesh::box({2 * half, side, side}, {12, 3, 3});
    for (int k = 1; k <= 3; ++k) {
        std::vector<Real> whole;
        for (const Mesh* mesh : {&whole_coarse, &whole_fine}) {
            World world(settings);
            const BodyHandle body = world.add_body(
                *mesh, {.material = world.add_material(rubber), .dynamics = BodyDynamics::explicit_elastic});
            whole.push_back(frequencies(world, {{body, mesh}}, k));
        }
        TwoHalves bar(settings);
        const Real tied = frequencies(bar.world, {{bar.left, &coarse}, {bar.right, &fine}}, k);
        CAPTURE(k, whole[0], whole[1], tied);
        CHECK(tied == Approx((whole[0] + whole[1]) / 2).epsilon(3e-3));
    }
}

TEST_CASE("a pad on a jointed rigid pendulum keeps the period", "[scene][ties]") {
    constexpr Real length = 0.4, width = 0.04, pad_side = 0.04;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        Settings settings = accurate({0, 0, -standard_gravity}, 1e-8);
        World world(settings);
        const Mesh bar = mesh::box({width, width, length}, {1, 1, 2}), pad = mesh::box({pad_side, pad_side, pad_side}, {2, 2, 2});
        const BodyHandle rigid = world.add_body(
            bar, {.material = world.add_material({}), .position = {0, 0, -length / 2}, .dynamics = BodyDynamics::rigid});
        const MaterialHandle stiff =
            world.add_material({.young_modulus = 2e6, .poisson_ratio = 0.3, .loss_factor = 0, .bulk_viscosity = 0});
        const BodyHandle soft =
            world.add_body(pad, {.material = dynamics == BodyDynamics::implicit_elastic
                                                 ? world.add_material({.young_modulus = 2e7, .poisson_ratio = 0.3})
                                                 : stiff,
                                 .position = {0, 0, -length - pad_side / 2},
                                 .dynamics = dynamics});
        Joints(world).add({.kind = JointKind::hinge, .first = rigid, .axis = {0, 1, 0}});
        std::vector<Index> top;
        for (std::size_t n = 0; n < pad.nodes.size(); ++n)
            if (pad.nodes[n].z() > 0.019) top.push_back(static_cast<Index>(n));
        const TieHandle tie = Ties(world).add({.body = soft, .nodes = top, .to_body = rigid});
        constexpr Real spin = 0.3;  // [rad/s] at the lowest point
        const auto turn = [&](BodyHandle body) {
            world.set_velocity(body, Vec3(0, spin, 0).cross(world.center_of_mass(body)), {0, spin, 0});
        };
        turn(rigid);
        turn(soft);
        const Real rod = 1000 * width * width * length, block = 1000 * pad_side * pad_side * pad_side;
        const Real at = length + pad_side / 2;
        const Real inertia = rod * (length * length / 3 + width * width / 12) +
                             block * (at * at + pad_side * pad_side / 6);
        const Real weight = standard_gravity * (rod * length / 2 + block * at);
        const Real amplitude = 2 * std::asin(spin * std::sqrt(inertia / weight) / 2);
        const Real expected = 4 * std::sqrt(inertia / weight) * std::comp_ellint_1(std::sin(amplitude / 2));
        std::vector<Real> passages;
        constexpr Real h = 1e-3;
        Real before = world.center_of_mass(rigid).x();
        while (passages.size() < 3 && world.time() < 5) {
            REQUIRE(world.advance(h).ok());
            const Real now = world.center_of_mass(rigid).x();
            if (world.time() > 0.1 && (before > 0) != (now > 0)) passages.push_back(world.time() - h * now / (now - before));
            before = now;
        }
        REQUIRE(passages.size() == 3);
        CAPTURE(static_cast<int>(dynamics));
        CHECK(passages[2] - passages[0] == Approx(expected).epsilon(1e-3));
        CHECK(Ties(world).state(tie).error < 1e-6);
        CHECK(world.report().momentum_error_share < 1e-9);
    }
}

TEST_CASE("a light soft block carries a body of ten thousand times its mass", "[scene][ties]") {
    for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::newton, SolverMethod::pgs}) {
        Settings settings = accurate();
        settings.method = method;
        World world(settings);
        const Mesh small = mesh::box({0.05, 0.05, 0.05}, {1, 1, 1}), large = mesh::box({0.5, 0.5, 0.5}, {1, 1, 1});
        const BodyHandle soft = world.add_body(small, {.material = world.add_material({.young_modulus = 1e9, .poisson_ratio = 0.3}),
                                                       .dynamics = BodyDynamics::implicit_elastic});
        const BodyHandle heavy = world.add_body(large, {.material = world.add_material({.density = 10000}),
                                                        .position = {0, 0, -0.275},
                                                        .dynamics = BodyDynamics::rigid});
        const auto at = [&](Real z) {
            std::vector<Index> nodes;
            for (std::size_t n = 0; n < small.nodes.size(); ++n)
                if (std::abs(small.nodes[n].z() - z) < 1e-9) nodes.push_back(static_cast<Index>(n));
            return nodes;
        };
        const TieHandle upper = Ties(world).add({.body = soft, .nodes = at(0.025)});
        const TieHandle lower = Ties(world).add({.body = soft, .nodes = at(-0.025), .to_body = heavy});
        REQUIRE(world.advance(2).ok());
        const Real weight = 10000 * 0.125 * standard_gravity;
        CAPTURE(static_cast<int>(method));
        CHECK(Ties(world).state(upper).force.z() == Approx(weight).epsilon(2e-3));
        CHECK(Ties(world).state(lower).force.z() == Approx(-weight).epsilon(2e-3));
        CHECK(Ties(world).state(lower).error < 1e-8);
    }
}

TEST_CASE("tied blocks slide with friction as one block", "[scene][ties]") {
    constexpr Real mu = 0.3, degrees = 30;
    World world(accurate(tilted_gravity(degrees)));
    const MaterialHandle of = world.add_material({.young_modulus = 1e6, .friction = mu, .damping = 100});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({side, side, side / 2}, {2, 2, 1}), above = mesh::box({side, side, side / 2}, {3, 3, 1});
    const BodyHandle lower = world.add_body(
        block, {.material = of, .position = {0, 0, side / 4}, .contact_distance = 0, .dynamics = BodyDynamics::implicit_elastic});
    const BodyHandle upper = world.add_body(
        above, {.material = of, .position = {0, 0, 3 * side / 4}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> bottom;
    for (std::size_t n = 0; n < above.nodes.size(); ++n)
        if (above.nodes[n].z() < 0) bottom.push_back(static_cast<Index>(n));
    const TieHandle tie = Ties(world).add({.body = upper, .nodes = bottom, .to_body = lower});
    REQUIRE(world.advance(0.2).ok());
    const Real before = world.center_of_mass(lower).x();
    REQUIRE(world.advance(0.2).ok());
    const Real angle = degrees * std::numbers::pi / 180;
    const Real rate = standard_gravity * (std::sin(angle) - mu * std::cos(angle));
    CHECK(world.center_of_mass(lower).x() - before == Approx(rate * (0.4 * 0.4 - 0.2 * 0.2) / 2).epsilon(0.02));
    CHECK(Ties(world).state(tie).error < 1e-7);
    CHECK(world.report().unconverged == 0);
}

TEST_CASE("a slide holds along the normal only", "[scene][ties]") {
    World world(accurate({2, 0, 5}));  // pulls away from the collider
    const MaterialHandle of = world.add_material({.young_modulus = 1e6});
    const ColliderHandle plane = world.add_collider(Plane{});
    const Mesh cube = mesh::box({side, side, side}, {2, 2, 2});
    const BodyHandle body =
        world.add_body(cube, {.material = of, .position = {0, 0, side / 2}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> bottom;
    for (std::size_t n = 0; n < cube.nodes.size(); ++n)
        if (cube.nodes[n].z() < -0.049) bottom.push_back(static_cast<Index>(n));
    const TieHandle tie = Ties(world).add({.kind = TieKind::slide, .body = body, .nodes = bottom, .to_collider = plane});
    REQUIRE(world.advance(0.5).ok());
    const TieState state = Ties(world).state(tie);
    CHECK(world.center_of_mass(body).x() == Approx(0.25).epsilon(1e-2));
    CHECK(state.error < 1e-9);
    CHECK(state.force.head<2>().norm() < 1e-9);
}

TEST_CASE("every solver method gives the same motion of tied bodies", "[scene][ties]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        std::vector<Vec3> expected;
        for (const auto& [method, name] : EnumNames<SolverMethod>::table) {
            Settings settings = without_gravity(1e-9);
            settings.method = method;
            settings.step_size = 1e-4;
            TwoHalves bar(settings, {}, dynamics);
            bar.world.set_velocity(bar.left, {0.1, 0, 0}, {1, 2, 3});
            REQUIRE(bar.world.advance(0.002).ok());
            const auto positions = bar.world.positions(bar.right);
            if (expected.empty()) expected.assign(positions.begin(), positions.end());
            Real worst = 0;
            for (std::size_t n = 0; n < expected.size(); ++n) worst = std::max(worst, (positions[n] - expected[n]).norm());
            CAPTURE(static_cast<int>(dynamics), name);
            CHECK(worst < 1e-9);
            CHECK(bar.world.report().unconverged == 0);
        }
    }
}

TEST_CASE("a tied world goes on bitwise from files and with any number of threads", "[scene][ties]") {
    struct Course {
        World world;
    };
    check_same_bits(
        [](int threads) {
            Settings settings;
            settings.threads = threads;
            TwoHalves bar(settings, {.break_force = 1}, BodyDynamics::implicit_elastic);
            bar.world.add_collider(Plane{}, {.position = {0, 0, -0.1}});
            CHECK(bar.world.advance(0.12).ok());
            return Course{std::move(bar.world)};
        },
        [](World& world) { CHECK(world.advance(0.1).ok()); });
}

TEST_CASE("tied bodies do not collide until the last node has broken off", "[scene][ties]") {
    TwoHalves bar(without_gravity(), {.break_force = 0.5});
    CHECK_FALSE(bar.world.may_collide(bar.left, bar.right));
    bar.world.set_velocity(bar.right, {3, 0, 0});
    REQUIRE(bar.world.advance(0.2).ok());
    const TieState state = Ties(bar.world).state(bar.tie);
    for (const TiedNode& node : state.nodes) CHECK(node.broken);
    CHECK(bar.world.may_collide(bar.left, bar.right));
    CHECK(bar.world.center_of_mass(bar.right).x() > half);
    Ties(bar.world).remove(bar.tie);
    CHECK_FALSE(Ties(bar.world).alive(bar.tie));
    CHECK(bar.world.may_collide(bar.left, bar.right));

    TwoHalves removed;
    removed.world.remove(removed.left);
    CHECK_FALSE(Ties(removed.world).alive(removed.tie));
    REQUIRE(removed.world.advance(0.01).ok());
}

TEST_CASE("ties refuse wrong settings by name", "[scene][ties]") {
    TwoHalves bar;
    const BodyHandle rigid = bar.world.add_body(
        coarse, {.material = bar.world.add_material({}), .position = {0, 1, 0}, .dynamics = BodyDynamics::rigid});
    const auto message = [&](const TieSettings& settings) {
        try {
            Ties(bar.world).add(settings);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    using Catch::Contains;
    CHECK_THAT(message({.body = rigid, .nodes = {0}}), Contains("body") && Contains("which is rigid"));
    CHECK_THAT(message({.body = bar.left}), Contains("nodes") && Contains("no node"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0, 1, 0}}), Contains("node 0 twice"));
    CHECK_THAT(message({.body = bar.left, .nodes = {100000}}), Contains("node 100000"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0}, .to_body = bar.left}), Contains("itself"));
    CHECK_THAT(message({.kind = TieKind::slide, .body = bar.left, .nodes = {0}}), Contains("no surface"));
    CHECK_THAT(message({.body = bar.left, .nodes = {0}, .break_force = 0}), Contains("break_force"));
    CHECK(Ties(bar.world).all().size() == 1);
}

}  // namespace skerry::test::ties_test
