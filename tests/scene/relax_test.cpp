// Static equilibria by dynamic relaxation, against closed forms and dynamic runs (docs/methods/loads.md 3).
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/load.h"
#include "skerry/refine.h"
#include "skerry/relax.h"
#include "skerry/tie.h"
#include "tests/support/hollow_sphere.h"
#include "tests/support/worlds.h"

namespace skerry::test::relax_test {

namespace {

std::vector<Index> nodes_above(const World& world, BodyHandle body, Real z) {
    std::vector<Index> list;
    const auto nodes = world.positions(body);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].z() > z) list.push_back(static_cast<Index>(n));
    return list;
}

Real lowest(const World& world, BodyHandle body) {
    Real z = infinity;
    for (const Vec3& x : world.positions(body)) z = std::min(z, x.z());
    return z;
}

}  // namespace

TEST_CASE("a hanging bar stretches by rho g L^2 / (2 E)", "[scene]") {
    constexpr Real L = 0.5, E = 1e6, density = 1000;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        CAPTURE(static_cast<int>(dynamics));
        World world;
        const auto material = world.add_material({.young_modulus = E, .poisson_ratio = 0.0, .density = density});
        const auto bar =
            world.add_body(mesh::box({0.1, 0.1, L}, {2, 2, 10}), {.material = material, .dynamics = dynamics});
        world.attach(bar, nodes_above(world, bar, L / 2 - 1e-6));
        const std::uint64_t steps = world.report().steps;
        const RelaxReport report = relax(world, {.tolerance = 1e-5});
        REQUIRE(report.converged);
        CHECK(report.residual <= 1e-5);
        CHECK(world.time() == 0);
        CHECK(world.report().steps == steps);
        for (const Vec3& v : world.velocities(bar)) CHECK(v == Vec3::Zero());
        const Real stretch = -L / 2 - lowest(world, bar), expected = density * standard_gravity * L * L / (2 * E);
        CHECK(stretch == Approx(expected).epsilon(0.01));
        // The state is at rest: a run does not move it.
        REQUIRE(world.advance(0.5).ok());
        CHECK(-L / 2 - lowest(world, bar) == Approx(stretch).epsilon(1e-3));
    }
}

TEST_CASE("a ball comes to rest where the dynamic run ends, in a tenth of the steps", "[scene]") {
    const auto make = [](Index threads) {
        Settings settings;
        settings.threads = threads;
        World world(settings);
        // Without friction there is only one equilibrium.
        const auto rubber = world.add_material({.young_modulus = 2e4, .friction = 0});
        world.add_collider(Plane{});
        world.add_body(mesh::ball(0.1, 6),
                       {.material = rubber, .position = {0, 0, 0.15}, .dynamics = BodyDynamics::explicit_elastic});
        return world;
    };
    World dynamic = make(1), relaxed = make(1), threads = make(3);
    REQUIRE(dynamic.advance(20).ok());  // A body falls asleep within a thousandth of its static state.
    const RelaxReport report = relax(relaxed);
    REQUIRE(report.converged);
    const auto height = [](const World& world) { return world.center_of_mass(world.bodies()[0]).z(); };
    CHECK(0.1 - height(relaxed) == Approx(0.1 - height(dynamic)).epsilon(3e-3));
    CHECK(static_cast<std::uint64_t>(report.steps) < dynamic.report().steps / 10);
    REQUIRE(relax(threads).converged);
    CHECK(threads.state_hash() == relaxed.state_hash());
}

TEST_CASE("a block on an incline rests below the friction angle and is reported above it", "[scene]") {
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::rigid}) {
        CAPTURE(static_cast<int>(dynamics));
        const auto on_incline = [&](Real degrees) {
            Settings settings;
            settings.gravity = tilted_gravity(degrees);
            World world(settings);
            const auto rubber = world.add_material({.young_modulus = 1e5, .friction = 0.5});  // 26.6 degrees
            world.add_collider(Plane{});
            world.add_body(mesh::box({0.2, 0.2, 0.1}, {2, 2, 1}),
                           {.material = rubber, .position = {0, 0, 0.051}, .dynamics = dynamics, .name = "block"});
            return world;
        };
        World below = on_incline(20), above = on_incline(33);
        const auto x = [](const World& world) { return world.center_of_mass(world.bodies()[0]).x(); };
        const RelaxReport rests = relax(below);
        CHECK(rests.converged);
        CHECK(std::abs(x(below)) < 0.01);
        above.settle_start();
        const auto hash = above.state_hash();
        const RelaxReport slides = relax(above, {.max_steps = 3000});
        CHECK(!slides.converged);
        CHECK(slides.steps == 3000);
        CHECK(slides.worst_name == "block");
        CHECK(slides.residual > 0.05);
        CHECK(slides.speed > 0.02);
        CHECK(above.state_hash() == hash);
    }
}

TEST_CASE("values over time and motions stay at the present time", "[scene]") {
    // A held bar whose load grows and that is moved sideways, and one with the constant load of the time 0.1 s.
    const auto make = [](const TimeTable& weight, const TimeTable& scale, const Vec3& velocity) {
        World world(accurate());
        const auto rubber = world.add_material({.young_modulus = 1e5});
        const auto bar = world.add_body(mesh::box({0.1, 0.1, 0.2}, {2, 2, 4}),
                                        {.material = rubber, .dynamics = BodyDynamics::explicit_elastic});
        world.attach(bar, nodes_above(world, bar, 0.0999), {.velocity = velocity});
        Loads loads(world);
        loads.add(GravityScale{.scale = weight});
        loads.add(ForceLoad{bar, {0, 1}, {0, 0, -1}, scale});
        return world;
    };
    World changing = make(TimeTable({{0, 0}, {0.1, 0}, {0.2, 1}}), TimeTable({{0, 0}, {0.1, 1}, {0.2, 5}}), {1, 0, 0}),
          constant = make(0, 1, Vec3::Zero());
    REQUIRE(changing.advance(0.1).ok());
    const AttachmentHandle held = changing.attachments()[0];
    const Vec3 place = changing.pose(held).position;
    REQUIRE(relax(changing, {.tolerance = 1e-5}).converged);
    REQUIRE(relax(constant, {.tolerance = 1e-5}).converged);
    const auto lowest_of = [](const World& world) { return lowest(world, world.bodies()[0]); };
    CHECK(-0.1 - lowest_of(changing) == Approx(-0.1 - lowest_of(constant)).epsilon(1e-3));
    CHECK(changing.pose(held).position == place);
    CHECK(changing.time() == 0.1);
    REQUIRE(changing.advance(0.1).ok());
    CHECK(changing.pose(held).position.x() == Approx(place.x() + 0.1).epsilon(1e-6));
    Loads loads(changing);
    CHECK(loads.state(loads.all()[1]).scale == Approx(5).epsilon(1e-6));
}

TEST_CASE("gas and a cable driven by a rate stay at rest during a relaxation", "[scene]") {
    World world(accurate());
    const auto rubber = world.add_material({.young_modulus = 1e5, .damping = 10});
    const auto bar = world.add_body(mesh::box({0.1, 0.1, 0.2}, {2, 2, 4}),
                                    {.material = rubber, .dynamics = BodyDynamics::explicit_elastic});
    world.attach(bar, nodes_above(world, bar, 0.0999));
    Cables cables(world);
    const CableHandle cable = cables.add(
        {.points = {{.point = {0.3, 0, -0.1}}, {.body = bar, .point = {0, 0, -0.1}}}, .drive = {.rate = -0.05}});
    Cavities cavities(world);
    const auto tank = [&](Real x, const GasFilling& gas) {
        const auto body = world.add_body(hollow_sphere(0.08, 0.1, 2, 1),
                                         {.material = rubber, .position = {x, 0, 0}, .dynamics = BodyDynamics::rigid});
        world.attach(body, std::vector<Index>{0, 1, 2, 3});
        return cavities.add({.body = body, .filling = gas});
    };
    const CavityHandle pumped = tank(1, {.inflow = 1e-4}), vented = tank(2, {.pressure = 2e4});
    const PipeHandle pipe = cavities.add({.first = vented, .conductance = 1e-9});
    REQUIRE(world.advance(0.02).ok());
    const CableState drawn = cables.state(cable);
    const Real pumped_mass = cavities.state(pumped).mass, vented_mass = cavities.state(vented).mass;
    const Real flow = cavities.state(pipe).flow;
    REQUIRE(drawn.work != 0);
    REQUIRE(flow > 0);
    REQUIRE(relax(world, {.tolerance = 1e-4}).converged);
    CHECK(cavities.state(pumped).mass == pumped_mass);
    CHECK(cavities.state(vented).mass == vented_mass);
    CHECK(cavities.state(pipe).flow == flow);
    CHECK(cavities.state(pipe).conductance == 1e-9);
    CHECK(cables.state(cable).released == drawn.released);
    CHECK(cables.state(cable).work == Approx(drawn.work).epsilon(1e-12));
    CHECK(cables.state(cable).dissipated == Approx(drawn.dissipated).margin(1e-12 * std::abs(drawn.work)));
    REQUIRE(world.advance(0.02).ok());
    CHECK(cavities.state(pumped).mass == Approx(pumped_mass + 2e-6).epsilon(1e-12));
    CHECK(cavities.state(vented).mass < vented_mass);
    CHECK(*cables.state(cable).released == Approx(*drawn.released - 1e-3).epsilon(1e-9));
}

TEST_CASE("a tie breaks after a relaxation, and only if it would break at rest", "[scene]") {
    struct Hanging {
        World world{accurate()};
        TieHandle tie;
        explicit Hanging(Real break_force) {
            const auto cube = world.add_body(
                mesh::box(Vec3::Constant(0.1), {2, 2, 2}),
                {.material = world.add_material({.young_modulus = 1e5}), .dynamics = BodyDynamics::explicit_elastic});
            tie =
                Ties(world).add({.body = cube, .nodes = nodes_above(world, cube, 0.0499), .break_force = break_force});
        }
        /// Number of nodes that have broken off.
        std::ptrdiff_t broken() {
            const TieState state = Ties(world).state(tie);
            return std::ranges::count_if(state.nodes, [](const TiedNode& node) { return node.broken.has_value(); });
        }
    };
    Hanging firm(infinity);
    REQUIRE(relax(firm.world, {.tolerance = 1e-4}).converged);
    Real largest = 0;  // force at rest [N]
    for (const TiedNode& node : Ties(firm.world).state(firm.tie).nodes) largest = std::max(largest, node.force.norm());

    // The forces overshoot their values at rest by more than a tenth on the way.
    Hanging strong(1.1 * largest), overloaded(1.1 * largest), weak(0.9 * largest);
    REQUIRE(overloaded.world.advance(0.2).ok());
    REQUIRE(overloaded.broken() > 0);
    REQUIRE(relax(strong.world, {.tolerance = 1e-4}).converged);
    CHECK(strong.broken() == 0);
    CHECK(Ties(strong.world).state(strong.tie).break_force == 1.1 * largest);
    REQUIRE(strong.world.advance(0.1).ok());
    CHECK(strong.broken() == 0);
    REQUIRE(relax(weak.world, {.tolerance = 1e-4}).converged);
    CHECK(weak.broken() == 0);
    REQUIRE(weak.world.advance(0.01).ok());
    CHECK(weak.broken() > 0);
}

TEST_CASE("load steps find the share of each kind of load at which a block begins to slide", "[scene]") {
    constexpr Real friction = 0.5, pull = 0.8;  // pull: fraction of the weight
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {1, 1, 1});
    const Real weight = 1000 * 0.2 * 0.2 * 0.1 * standard_gravity, traction = pull * weight / (0.2 * 0.1);
    const auto right = [](const World& world, BodyHandle block) {
        return faces_where(world, block, [](const Vec3& x) { return x.x() > 0; });
    };
    const auto nodal = [&](World& world, BodyHandle block) {
        world.set_loads(block, std::vector<Vec3>(8, Vec3(pull * weight / 8, 0, 0)));
    };
    const auto force = [&](World& world, BodyHandle block) {
        Loads(world).add(ForceLoad{block, {0, 1, 2, 3, 4, 5, 6, 7}, {pull * weight, 0, 0}});
    };
    const auto on_faces = [&](World& world, BodyHandle block) {
        Loads(world).add(TractionLoad{block, right(world, block), {traction, 0, 0}});
    };
    const auto field = [&](World& world, BodyHandle block) {
        Loads(world).add(AccelerationField{block, {pull * standard_gravity, 0, 0}});
    };
    const auto pressure = [&](World& world, BodyHandle block) {
        Cavities(world).add({.body = block, .faces = right(world, block), .filling = TimeTable(traction)});
    };
    const auto cable = [&](World& world, BodyHandle block) {
        Cables(world).add({.points = {{.point = {1, 0, 0.05}}, {.body = block, .point = {0, 0, 0.05}}},
                           .drive = {.tension = pull * weight}});
    };
    const std::array<std::function<void(World&, BodyHandle)>, 6> kinds{nodal, force, on_faces, field, pressure, cable};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        CAPTURE(kind);
        World world(accurate());
        const MaterialHandle rough = world.add_material({.density = 1000, .friction = friction});
        world.add_collider(Plane{});
        const BodyHandle block =
            world.add_body(mesh, {.material = rough, .position = {0, 0, 0.05}, .dynamics = BodyDynamics::rigid});
        kinds[kind](world, block);
        world.settle_start();
        const auto hash = world.state_hash();
        const RelaxReport slides = relax(world, {.tolerance = 1e-4, .max_steps = 100, .load_steps = 4});
        CHECK(!slides.converged);
        CHECK(slides.load <= friction / pull);
        CHECK(slides.load > friction / pull - 1.0 / 128);
        CHECK(world.state_hash() == hash);
    }
}

TEST_CASE("load steps end in the equilibrium of the whole loads", "[scene]") {
    const auto lowest_after = [](int load_steps) {
        World world(accurate());
        const auto bar = world.add_body(
            mesh::box({0.1, 0.1, 0.2}, {2, 2, 4}),
            {.material = world.add_material({.young_modulus = 1e5}), .dynamics = BodyDynamics::explicit_elastic});
        world.attach(bar, nodes_above(world, bar, 0.0999));
        const LoadHandle load = Loads(world).add(ForceLoad{bar, {0, 1}, {0, 0, -1}, TimeTable({{0, 2}, {1, 5}})});
        const RelaxReport report = relax(world, {.tolerance = 1e-5, .load_steps = load_steps});
        CHECK(report.converged);
        CHECK(report.load == 1);
        CHECK(Loads(world).state(load).scale == 2);
        return lowest(world, bar);
    };
    CHECK(lowest_after(3) + 0.1 == Approx(lowest_after(1) + 0.1).epsilon(1e-3));
}

TEST_CASE("the sag of a bar converges with the order 2 if its mesh is refined", "[scene]") {
    // The sag of the centre of mass is the work of the weight over the weight. Its error is that of the energy, which
    // linear elements reduce with the square of their size: by 4 for each refinement.
    constexpr Real L = 0.4, E = 1e8, density = 1000;
    Mesh mesh = mesh::box({0.1, 0.1, L}, {1, 1, 4});
    for (Vec3& x : mesh.nodes)
        if (std::abs(x.z()) < 0.4 * L) x.z() += 0.02 * std::sin(40 * x.x() + 60 * x.y());
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z() == L / 2) mesh.sets["top"].nodes.push_back(static_cast<Index>(n));
    const Real exact = density * standard_gravity * L * L / (3 * E);
    std::vector<Real> error;
    for (int level = 0; level < 3; ++level) {
        World world;
        const auto material = world.add_material({.young_modulus = E, .poisson_ratio = 0.0, .density = density});
        const auto bar = world.add_body(mesh, {.material = material, .element = ElementKind::linear});
        world.attach(bar, mesh.sets["top"].nodes);
        const Real start = world.center_of_mass(bar).z();
        REQUIRE(relax(world, {.tolerance = 1e-6}).converged);
        error.push_back(1 - (start - world.center_of_mass(bar).z()) / exact);
        mesh = mesh::refine(std::move(mesh));
    }
    CHECK(error[0] < 0.05);
    for (std::size_t level = 0; level < 2; ++level) {
        CAPTURE(error[level], error[level + 1]);
        CHECK(std::log2(error[level] / error[level + 1]) == Approx(2).margin(0.15));
    }
}

TEST_CASE("a relaxation that fails or is refused leaves the world whole", "[scene]") {
    World world;
    const auto rubber = world.add_material({.young_modulus = 1e5});
    const auto body = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                     {.material = rubber, .dynamics = BodyDynamics::explicit_elastic});
    world.set_loads(body, std::vector<Vec3>(27, Vec3(1e30, 0, 0)));
    world.settle_start();
    const auto hash = world.state_hash();
    const RelaxReport report = relax(world);
    CHECK(!report.converged);
    CHECK(!report.message.empty());
    CHECK(report.load == 0);
    CHECK(world.state_hash() == hash);
    CHECK_THROWS_WITH(relax(world, {.tolerance = 0}), Catch::Contains("tolerance") && Catch::Contains("> 0 and < 1"));
    CHECK_THROWS_WITH(relax(world, {.max_steps = 0}), Catch::Contains("max_steps"));
    CHECK_THROWS_WITH(relax(world, {.load_steps = 0}), Catch::Contains("load_steps") && Catch::Contains("found 0"));
}

}  // namespace skerry::test::relax_test
