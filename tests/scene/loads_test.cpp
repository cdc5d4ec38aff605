// Loads and force fields in whole steps, against closed forms (docs/methods/loads.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "skerry/load.h"
#include "skerry/relax.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::loads_test {

namespace {

const std::array all_kinds{BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid};
const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
constexpr Real cube_mass = 1000 * 0.1 * 0.1 * 0.1;  // [kg]
/// A pulse with the integral 0.5 * 0.1 * 2 + 0.05 * (2 - 1) / 2 = 0.125 s.
const TimeTable pulse({{0.1, 0}, {0.15, 2}, {0.2, -1}, {0.25, 0}});
constexpr Real integral_of_pulse = 0.05 * 1 + 0.05 * 0.5 - 0.05 * 0.5;  // [s]

Settings weightless(Real step = 0) {
    Settings settings = accurate(Vec3::Zero());
    if (step > 0) settings.step_size = step;
    return settings;
}

struct Flight {
    World world;
    MaterialHandle material;
    BodyHandle body;

    Flight(const Settings& settings, BodyDynamics dynamics, const MaterialSettings& of_body = {})
        : world(settings),
          material(world.add_material(of_body)),
          body(world.add_body(cube, {.material = material, .dynamics = dynamics, .name = "cube"})) {}
    Vec3 velocity() const { return world.velocity(body).velocity; }
};

std::vector<Index> nodes_where(const World& world, BodyHandle body, auto&& inside) {
    std::vector<Index> list;
    const auto nodes = world.positions(body);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (inside(nodes[n])) list.push_back(static_cast<Index>(n));
    return list;
}

std::vector<Index> all_nodes() {
    std::vector<Index> list(cube.nodes.size());
    for (std::size_t n = 0; n < list.size(); ++n) list[n] = static_cast<Index>(n);
    return list;
}

}  // namespace

TEST_CASE("the impulse of a table is its integral, whatever the kind of body and the steps", "[scene]") {
    for (const BodyDynamics dynamics : all_kinds)
        for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog})
            for (const Real step : {1.0 / 300, 1.0 / 937, 1.0 / 5000}) {
                CAPTURE(static_cast<int>(dynamics), static_cast<int>(integrator), step);
                Settings settings = weightless(step);
                settings.integrator = integrator;
                Flight flight(settings, dynamics);
                Loads loads(flight.world);
                loads.add(ForceLoad{flight.body, all_nodes(), {3, 0, 0}, pulse});
                loads.add(AccelerationField{.acceleration = {0, 5, 0}, .scale = pulse});
                // lengths of calls that change the length of the steps
                for (const Real dt : {0.0771, 0.1, 0.0129, 0.11}) REQUIRE(flight.world.advance(dt).ok());
                CHECK(flight.velocity().x() == Approx(3 * integral_of_pulse / cube_mass).epsilon(1e-13));
                CHECK(flight.velocity().y() == Approx(5 * integral_of_pulse).epsilon(1e-13));
                CHECK(flight.world.report().momentum_error_share < 1e-12);
            }
}

TEST_CASE("a factor of the weight turns gravity on over time", "[scene]") {
    const Real half = 0.25;
    for (const BodyDynamics dynamics : all_kinds) {
        CAPTURE(static_cast<int>(dynamics));
        Settings settings = accurate();
        settings.step_size = 1.0 / 1000;
        Flight flight(settings, dynamics);
        Loads loads(flight.world);
        loads.add(GravityScale{.scale = TimeTable({{0.1, 0}, {0.1 + 2 * half, 1}})});
        const LoadHandle off = loads.add(GravityScale{flight.body, 0});
        REQUIRE(flight.world.advance(0.05).ok());
        CHECK(flight.velocity().norm() < 1e-15);
        CHECK(loads.state(off).force.z() == Approx(cube_mass * standard_gravity));
        loads.remove(off);  // from now on the factor of all bodies applies
        REQUIRE(flight.world.advance(0.05 + 2 * half).ok());
        // Velocities of explicit and rigid bodies belong to the middle of the last step.
        const Real late = dynamics == BodyDynamics::implicit_elastic ? 0 : 0.5e-3;
        const Real reached = half - late + late * late / (4 * half);
        CHECK(flight.velocity().z() == Approx(-standard_gravity * reached).epsilon(1e-12));
        CHECK(flight.world.report().energy_error_share < 1e-3);
    }
}

TEST_CASE("a field of one body leaves other bodies alone", "[scene]") {
    Flight flight(weightless(), BodyDynamics::rigid);
    const BodyHandle other = flight.world.add_body(
        cube, {.material = flight.material, .position = {1, 0, 0}, .dynamics = BodyDynamics::rigid});
    Loads loads(flight.world);
    loads.add(AccelerationField{flight.body, {0, 0, 2}});
    loads.add(DragField{.body = other, .rate = 1, .wind = {0, 1, 0}});
    REQUIRE(flight.world.advance(0.5).ok());
    CHECK(flight.velocity().isApprox(Vec3(0, 0, 1), 1e-12));
    CHECK(std::abs(flight.world.velocity(other).velocity.z()) < 1e-15);
    CHECK(flight.world.velocity(other).velocity.y() > 0.3);
}

TEST_CASE("drag gives the terminal velocity exactly and the decay to first order in the step", "[scene]") {
    constexpr Real rate = 4;
    for (const BodyDynamics dynamics : all_kinds) {
        CAPTURE(static_cast<int>(dynamics));
        Flight falls(accurate(), dynamics);
        Loads(falls.world).add(DragField{.rate = rate, .wind = {1, 0, 0}});
        REQUIRE(falls.world.advance(6).ok());  // the difference decays by exp(-24)
        CHECK(falls.velocity().isApprox(Vec3(1, 0, -standard_gravity / rate), 1e-9));

        const auto error = [&](Real step) {
            Flight flight(weightless(step), dynamics);
            flight.world.set_velocity(flight.body, {1, 0, 0}, {0, 0, 3});
            Loads(flight.world).add(DragField{.rate = rate});
            REQUIRE(flight.world.advance(0.5).ok());
            CHECK(flight.world.report().energy_error_share < 0.01);
            return std::abs(flight.velocity().x() - std::exp(-rate * 0.5));
        };
        const Real coarse = error(1e-3), fine = error(1e-4);
        CHECK(coarse < rate * 0.5 * std::exp(-rate * 0.5) * rate * 1e-3);
        CHECK(fine == Approx(coarse / 10).epsilon(0.05));
    }
}

TEST_CASE("a stiff drag that is added in flight never speeds a body up", "[scene]") {
    constexpr Real rate = 1e5;  // [1/s]; the steps before are up to a thousand times longer than 1 / rate
    for (const BodyDynamics dynamics : all_kinds) {
        CAPTURE(static_cast<int>(dynamics));
        Flight flight(weightless(), dynamics);
        flight.world.set_velocity(flight.body, {1, 0, 0}, Vec3::Zero());
        REQUIRE(flight.world.advance(0.05).ok());
        Loads(flight.world).add(DragField{.rate = rate});
        Real last = 1;
        for (int k = 0; k < 10; ++k) {
            REQUIRE(flight.world.advance(1 / rate).ok());
            const Real speed = flight.velocity().norm();
            CHECK(speed <= std::max(0.6 * last, 1e-9));  // below 1e-9 m/s rounding errors remain
            last = speed;
        }
    }
}

TEST_CASE("drag slows the rotation of rigid bodies with given masses", "[scene]") {
    constexpr Real rate = 2;
    World world(weightless(1e-3));
    BodySettings settings{.material = world.add_material({}),
                          .angular_velocity = {0, 0, 3},
                          .dynamics = BodyDynamics::rigid,
                          .mass = 1,
                          .inertia = Mat3(Vec3(0.02, 0.03, 0.04).asDiagonal())};
    // The centre is in the middle of the nodes, or so far away that nodes have negative masses.
    std::vector<BodyHandle> bodies;
    for (const Real x : {0.0, 1.0}) {
        settings.center_of_mass = Vec3(x, 0, 0);
        settings.position = {0, 3 * x, 0};
        bodies.push_back(world.add_body(cube, settings));
    }
    const Vec3 wind(1, 0, 0.5);
    Loads(world).add(DragField{.rate = rate, .wind = wind});
    REQUIRE(world.advance(0.5).ok());
    const Real decay = std::exp(-rate * 0.5);
    for (const BodyHandle body : bodies) {
        // The error of the scheme is in proportion to rate times step.
        CHECK((world.velocity(body).angular_velocity - decay * Vec3(0, 0, 3)).norm() < 3e-3 * decay * 3);
    }
    const Vec3 start = Vec3(0, 0, 0);
    CHECK((world.velocity(bodies[1]).velocity - (wind + decay * (start - wind))).norm() < 3e-3);
}

TEST_CASE("drag shortens the stable step as the quadratic inequality says", "[scene]") {
    Flight flight(weightless(), BodyDynamics::explicit_elastic, lossless({}));
    const Real free = flight.world.stable_step();
    Loads loads(flight.world);
    const LoadHandle drag = loads.add(DragField{.rate = 0.5 / free});
    const Real with = flight.world.stable_step();
    // (omega h)^2 = 4 - 2 c h with omega = 2 / free
    CHECK(4 * with * with / (free * free) == Approx(4 - 2 * 0.5 / free * with));
    loads.remove(drag);
    CHECK(flight.world.stable_step() == free);
    loads.add(DragField{.rate = 1e4 / free});
    CHECK(flight.world.stable_step() == Approx(free / 1e4));
    Flight rigid(weightless(), BodyDynamics::rigid);
    Loads(rigid.world).add(DragField{.rate = 1e4});
    CHECK(rigid.world.stable_step() == Approx(1e-4));
}

TEST_CASE("tractions on both ends of a bar cause a uniform stress", "[scene]") {
    // A patch test: the irregular faces of the ends share the force such that the stress is uniform up to the remaining
    // vibration.
    constexpr Real pull = 1000;  // [Pa]
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        CAPTURE(static_cast<int>(dynamics));
        World world(weightless());
        const auto rubber = world.add_material({.young_modulus = 1e5, .damping = 60});
        const auto bar =
            world.add_body(mesh::box({0.3, 0.1, 0.1}, {6, 3, 2}), {.material = rubber, .dynamics = dynamics});
        Loads loads(world);
        const auto left = faces_where(world, bar, [](const Vec3& x) { return x.x() < -0.1499; });
        const auto right = faces_where(world, bar, [](const Vec3& x) { return x.x() > 0.1499; });
        REQUIRE(left.size() == 12);
        loads.add(TractionLoad{bar, left, {-pull, 0, 0}});
        const LoadHandle load = loads.add(TractionLoad{bar, right, {pull, 0, 0}});
        CHECK(loads.state(load).force.isApprox(Vec3(pull * 0.01, 0, 0), 1e-14));
        REQUIRE(world.advance(3).ok());
        // The traction acts on the rest area, so the first Piola-Kirchhoff stress is `pull`.
        Real most = 0, least = infinity;
        for (const Mat3& stress : world.stress(bar)) {
            most = std::max(most, stress(0, 0));
            least = std::min(least, stress(0, 0));
        }
        CHECK(most - least < 1e-6 * pull);
        CHECK(most == Approx(pull).epsilon(0.02));
    }
}

TEST_CASE("a traction on the present area is the Cauchy stress, one on the rest area keeps its force", "[scene]") {
    constexpr Real pull = 4e4, rest_area = 0.01;  // [Pa, m^2]
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic})
        for (const LoadArea on : {LoadArea::reference, LoadArea::present}) {
            CAPTURE(static_cast<int>(dynamics), static_cast<int>(on));
            World world(weightless());
            const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3});
            const auto bar =
                world.add_body(mesh::box({0.2, 0.1, 0.1}, {4, 2, 2}), {.material = rubber, .dynamics = dynamics});
            Loads loads(world);
            const auto left = faces_where(world, bar, [](const Vec3& x) { return x.x() < -0.0999; });
            const auto right = faces_where(world, bar, [](const Vec3& x) { return x.x() > 0.0999; });
            loads.add(TractionLoad{.body = bar, .faces = left, .traction = {-pull, 0, 0}, .area = on});
            const LoadHandle load =
                loads.add(TractionLoad{.body = bar, .faces = right, .traction = {pull, 0, 0}, .area = on});
            REQUIRE(relax(world, {.tolerance = 1e-5}).converged);
            // The bar is stretched uniformly, so its width follows from its corners.
            const auto nodes = world.positions(bar);
            const Real width = nodes.back().y() - nodes.front().y();
            CHECK(width < 0.095);
            const Real area = on == LoadArea::present ? width * width : rest_area;
            CHECK(loads.state(load).force.x() == Approx(pull * area).epsilon(1e-4));
            for (const Mat3& stress : world.stress(bar))
                CHECK(stress(0, 0) == Approx(pull * area / (width * width)).epsilon(1e-3));
        }
}

TEST_CASE("a traction on the present area shortens the stable step by its bound", "[scene]") {
    Flight flight(weightless(), BodyDynamics::explicit_elastic, lossless({}));
    const Real free = flight.world.stable_step();
    constexpr Real pull = 3e7;  // [Pa]
    const auto top = faces_where(flight.world, flight.body, [](const Vec3& x) { return x.z() > 0.0499; });
    const LoadHandle load = Loads(flight.world)
                                .add(TractionLoad{.body = flight.body,
                                                  .faces = top,
                                                  .traction = {0, pull, 0},
                                                  .scale = TimeTable({{0, 0}, {1, -2}}),
                                                  .area = LoadArea::present});
    const std::vector<Real> mass = node_masses(flight.world, flight.body, cube, 1000);
    const Real longest = 0.05 * std::sqrt(2);  // edge of all faces [m]
    Real most = 0;                             // of faces per mass [1/kg]
    for (std::size_t n = 0; n < mass.size(); ++n)
        most = std::max(
            most,
            static_cast<Real>(std::ranges::count_if(
                top, [&](const auto& face) { return std::ranges::find(face, static_cast<Index>(n)) != face.end(); })) /
                mass[n]);
    const Real with = flight.world.stable_step();
    CHECK(4 / (with * with) - 4 / (free * free) == Approx(2 * pull / 2 * longest * most).epsilon(1e-6));
    Loads(flight.world).set_scale(load, 0);
    CHECK(flight.world.stable_step() == free);
}

TEST_CASE("a force on the tip bends a beam as the beam formula says", "[scene]") {
    // Timoshenko: F L^3 / (3 E I) + F L / (k G A) with k = 5/6. The clamped end, where Poisson's ratio is 0, has no
    // boundary layer.
    constexpr Real L = 1, side = 0.1, E = 1e7, F = 1;
    constexpr Real expected =
        F * L * L * L / (3 * E * side * side * side * side / 12) + F * L / (5.0 / 6 * E / 2 * side * side);
    World world(weightless());
    const auto material = world.add_material({.young_modulus = E, .poisson_ratio = 0.0});
    const auto beam = world.add_body(mesh::box({L, side, side}, {40, 4, 4}),
                                     {.material = material, .dynamics = BodyDynamics::implicit_elastic});
    world.attach(beam, nodes_where(world, beam, [](const Vec3& x) { return x.x() < -0.4999; }));
    const auto tip = nodes_where(world, beam, [](const Vec3& x) { return x.x() > 0.4999; });
    Loads(world).add(ForceLoad{beam, tip, {0, 0, -F}});
    REQUIRE(relax(world, {.tolerance = 1e-5}).converged);
    Real sunk = 0;
    for (const Index n : tip)
        sunk -= world.positions(beam)[static_cast<std::size_t>(n)].z() / static_cast<Real>(tip.size());
    CHECK(sunk == Approx(expected).epsilon(0.02));
}

TEST_CASE("loads are counted in the balance of energy", "[scene]") {
    for (const BodyDynamics dynamics : all_kinds) {
        CAPTURE(static_cast<int>(dynamics));
        Flight flight(accurate(), dynamics, lossless({}));
        Loads loads(flight.world);
        loads.add(ForceLoad{flight.body, {0, 1, 2}, {3, 0, 1}, pulse});
        loads.add(AccelerationField{.acceleration = {0, 5, 0}, .scale = pulse});
        loads.add(DragField{.rate = 2, .wind = {1, 0, 0}, .scale = pulse});
        loads.add(GravityScale{.scale = TimeTable({{0, 1}, {0.3, 0.5}})});
        loads.add(TractionLoad{.body = flight.body,
                               .faces = faces_where(flight.world, flight.body, [](const Vec3& x) { return x.z() > 0; }),
                               .traction = {0, 0, 500},
                               .scale = pulse,
                               .area = LoadArea::present});
        REQUIRE(flight.world.advance(0.5).ok());
        CHECK(flight.velocity().x() > 0);
        CHECK(flight.velocity().y() > 0.1);
        CHECK(flight.world.report().energy_error_share < 5e-3);
        CHECK(flight.world.report().momentum_error_share < 1e-12);
    }
}

namespace {

World busy_loads(int threads) {
    Settings settings;
    settings.threads = threads;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 1e5});
    world.add_collider(Plane{});
    Loads loads(world);
    for (int k = 0; k < 3; ++k) {
        const auto body = world.add_body(
            cube,
            {.material = rubber, .position = {0.15 * k, 0, 0.055}, .dynamics = all_kinds[static_cast<std::size_t>(k)]});
        loads.add(ForceLoad{body, {k, 4, 7}, {0.5, 0, 1}, pulse});
        loads.add(GravityScale{body, TimeTable({{0, 1}, {0.3, 0.8 - 0.1 * k}})});
        loads.add(TractionLoad{.body = body,
                               .faces = {world.surface(body)[0], world.surface(body)[1]},
                               .traction = {20, 0, 0},
                               .area = LoadArea::present});
    }
    loads.add(DragField{.rate = 2, .wind = {0.1, 0, 0}, .scale = pulse});
    loads.add(AccelerationField{.acceleration = {1, 0, 0}, .scale = pulse});
    loads.remove(loads.all()[2]);
    return world;
}

}  // namespace

TEST_CASE("loads give the same bits with 1 and 3 threads, after saving and with removed rows", "[scene]") {
    World one = busy_loads(1), three = busy_loads(3);
    REQUIRE(one.advance(0.13).ok());
    REQUIRE(three.advance(0.13).ok());
    CHECK(one.state_hash() == three.state_hash());
    const TemporaryFolder folder;
    one.save(folder.path() / "loads.h5");
    World loaded = World::load(folder.path() / "loads.h5"), cloned = one.clone();
    for (World* world : {&one, &loaded, &cloned}) REQUIRE(world->advance(0.17).ok());
    CHECK(loaded.state_hash() == one.state_hash());
    CHECK(cloned.state_hash() == one.state_hash());
    Loads loads(one);
    const auto before = one.state_hash();
    loads.set_scale(loads.all()[0], pulse);
    CHECK(one.state_hash() == before);
    loads.set_scale(loads.all()[0], 2);
    CHECK(one.state_hash() != before);
}

TEST_CASE("loads do not depend on how often advance is called", "[scene]") {
    const auto run = [](int calls) {
        Flight flight(weightless(1.0 / 1024), BodyDynamics::explicit_elastic);
        Loads(flight.world).add(ForceLoad{flight.body, {0}, {0.1, 0, 0}, pulse});
        for (int i = 0; i < calls; ++i) REQUIRE(flight.world.advance(0.25 / calls).ok());
        CHECK(flight.velocity().x() > 0);
        return flight.world.state_hash();
    };
    CHECK(run(1) == run(16));
}

TEST_CASE("a changing load wakes a sleeping body and keeps it awake, a constant load lets it sleep", "[scene]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::rigid}) {
        CAPTURE(static_cast<int>(dynamics));
        World world;
        const auto rubber = world.add_material({.young_modulus = 1e5});
        world.add_collider(Plane{});
        const auto body = world.add_body(cube, {.material = rubber, .position = {0, 0, 0.0502}, .dynamics = dynamics});
        Loads loads(world);
        // A ramp that is too weak to move the block.
        const LoadHandle load = loads.add(ForceLoad{body, {0}, {0.1, 0, 0}, TimeTable({{4, 1}, {6, 2}})});
        REQUIRE(world.advance(3.9).ok());
        CHECK(world.asleep(body));
        REQUIRE(world.advance(0.2).ok());
        CHECK(!world.asleep(body));
        int asleep = 0;
        world.watch_steps([&](const StepReport&) { asleep += world.asleep(body); });
        REQUIRE(world.advance(1.8).ok());
        CHECK(asleep == 0);
        world.watch_steps({});
        REQUIRE(world.advance(3).ok());
        CHECK(world.asleep(body));
        loads.set_vector(load, {0.2, 0, 0});
        CHECK(!world.asleep(body));
        REQUIRE(world.advance(3).ok());
        REQUIRE(world.asleep(body));
        loads.set_vector(load, {0.2, 0, 0});
        CHECK(world.asleep(body));
        loads.remove(load);
        CHECK(!world.asleep(body));
    }
}

TEST_CASE("loads follow a body whose dynamics change, and go with a removed body", "[scene]") {
    Flight flight(weightless(), BodyDynamics::explicit_elastic);
    const BodyHandle first = flight.world.add_body(
        cube, {.material = flight.material, .position = {1, 0, 0}, .dynamics = BodyDynamics::rigid});
    Loads loads(flight.world);
    const LoadHandle of_first = loads.add(ForceLoad{first, all_nodes(), {1, 0, 0}});
    const LoadHandle load = loads.add(ForceLoad{flight.body, all_nodes(), {0, 1, 0}});
    flight.world.set_dynamics(flight.body, BodyDynamics::rigid);
    REQUIRE(loads.state(load).body == flight.body);
    REQUIRE(flight.world.advance(0.5).ok());
    CHECK(flight.velocity().isApprox(Vec3(0, 0.5, 0), 1e-12));
    flight.world.remove(first);
    CHECK(!loads.alive(of_first));
    CHECK(loads.all() == std::vector{load});
    REQUIRE(flight.world.advance(0.5).ok());
    CHECK(flight.velocity().isApprox(Vec3(0, 1, 0), 1e-12));
    loads.remove(load);
    REQUIRE(flight.world.advance(0.5).ok());
    CHECK(flight.velocity().isApprox(Vec3(0, 1, 0), 1e-12));
    CHECK(flight.world.report().energy_error_share < 1e-9);
}

TEST_CASE("loads that cannot be are refused by name, and change nothing", "[scene]") {
    Flight flight(weightless(), BodyDynamics::explicit_elastic);
    const BodyHandle round = flight.world.add_body(Sphere{0.1}, {.material = flight.material, .position = {2, 0, 0}});
    Loads loads(flight.world);
    const auto before = flight.world.state_hash();
    using Catch::Contains;
    CHECK_THAT(message_of([&] {
                   loads.add(ForceLoad{flight.body, {}, {1, 0, 0}});
               }),
               Contains("nodes") && Contains("an empty list"));
    CHECK_THAT(message_of([&] {
                   loads.add(ForceLoad{flight.body, {1, 27}, {1, 0, 0}});
               }),
               Contains("cube") && Contains("node 27") && Contains("0 to 26"));
    CHECK_THAT(message_of([&] { loads.add(ForceLoad{flight.body, {1, 1}, {1, 0, 0}}); }), Contains("node 1 twice"));
    CHECK_THAT(message_of([&] {
                   loads.add(TractionLoad{round, {{0, 1, 2}}, {1, 0, 0}});
               }),
               Contains("which is a sphere"));
    CHECK_THAT(message_of([&] {
                   loads.add(TractionLoad{flight.body, {{0, 1, 26}}, {1, 0, 0}});
               }),
               Contains("nodes 0, 1 and 26") && Contains("surface of body 'cube'"));
    CHECK_THAT(message_of([&] { loads.add(DragField{.rate = 0}); }), Contains("rate") && Contains("> 0"));
    CHECK_THAT(message_of([&] {
                   loads.add(AccelerationField{.acceleration = {NAN, 0, 0}});
               }),
               Contains("acceleration"));
    CHECK_THAT(message_of([&] {
                   loads.add(ForceLoad{flight.body, {1}, {1, 0, 0}, TimeTable({{1, 0}, {1, 2}})});
               }),
               Contains("scale[1].time"));
    CHECK(loads.all().empty());
    CHECK(flight.world.state_hash() == before);
    const LoadHandle factor = loads.add(GravityScale{.scale = 0.5});
    CHECK_THAT(message_of([&] { loads.add(GravityScale{.scale = 2}); }), Contains("a second factor of the weight"));
    CHECK_THAT(message_of([&] { loads.set_vector(factor, {1, 0, 0}); }), Contains("set_scale()"));
    loads.remove(factor);
    CHECK_THAT(message_of([&] { loads.state(factor); }), Contains("a handle without an object"));
}

}  // namespace skerry::test::loads_test
