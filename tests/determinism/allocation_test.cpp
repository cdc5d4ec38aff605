// A step in a steady state allocates no memory. This program replaces malloc by a version that counts.
#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "engine/world/tuning.h"
#include "jobs/executor.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/rollout.h"
#include "skerry/spring.h"
#include "skerry/surface.h"
#include "skerry/tie.h"
#include "tests/support/worlds.h"

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_memalign(std::size_t, std::size_t);

namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0}, bytes{0};

void count(std::size_t size) {
    if (!counting.load(std::memory_order_relaxed)) return;
    ++allocations;
    bytes += static_cast<long>(size);
}
}  // namespace

// operator new, Eigen and the backends all end in one of these three.
extern "C" void* malloc(std::size_t size) {
    count(size);
    return __libc_malloc(size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) {
    count(size);
    return __libc_memalign(alignment, size);
}
extern "C" int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
    count(size);
    *memory = __libc_memalign(alignment, size);
    return *memory ? 0 : 12;
}

namespace skerry::test::determinism_allocation_test {

namespace {

/// Few threads: a thread that TBB starts after others allocates on its own, at any time.
Settings two_threads() {
    Settings settings;
    settings.threads = 2;
    return settings;
}

World resting_balls(Backend backend, int threads, Settings settings = {}, const Tuning& tuning = {}) {
    settings.backend = backend;
    settings.threads = threads;
    settings.start_overlaps = StartOverlaps::ignore;  // overlapping balls are pushed apart before they rest
    World world = tuned_world(settings, tuning);
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.5, .damping = 20});
    world.add_collider(Plane{});
    const Mesh ball = mesh::ball(0.05, 6);
    for (int i = 0; i < 6; ++i)
        world.add_body(ball, {.material = rubber, .position = {0.07 * (i % 3), 0.0, 0.06 + 0.1 * (i / 3)}});
    return world;
}

long allocations_of_a_fifth_second(World& world) {
    allocations = 0;
    counting = true;
    const StepReport report = world.advance(0.2);
    counting = false;
    REQUIRE(report.ok());
    REQUIRE(world.contacts().size() > 10);
    return allocations;
}

}  // namespace

TEST_CASE("the counter sees an allocation", "[determinism]") {
    allocations = 0;
    counting = true;
    Column<double> column;
    column.resize(100);
    counting = false;
    CHECK(allocations > 0);
    CHECK(column.size() == 100);
}

TEST_CASE("a resting pile allocates nothing in a fifth of a second of steps", "[determinism]") {
    for (Backend backend : available_backends()) {
        // libgomp allocates memory for each of its tasks. Skerry's own allocations do not depend on the backend.
        if (backend == Backend::openmp) continue;
        for (int threads : {1, 2}) {
            INFO(name_of(backend) << " with " << threads);
            World world = resting_balls(backend, threads);
            REQUIRE(world.advance(1.5).ok());
            CHECK(allocations_of_a_fifth_second(world) == 0);
            if (backend == Backend::serial) break;
        }
    }
}

TEST_CASE("further intervals of a rollout allocate only where tables grow", "[determinism]") {
    Settings settings;
    settings.sleep = false;
    World world = resting_balls(Backend::serial, 1, settings);
    const ColliderHandle plate = world.add_collider(Box{{0.1, 0.1, 0.01}}, {.position = {2, 0, 0.1}});
    REQUIRE(world.advance(1.5).ok());
    const BodyHandle ball = world.bodies().front();
    const auto allocated = [&](std::size_t intervals) {
        std::vector<Real> pose, force, weight;
        for (std::size_t i = 0; i < intervals; ++i) {
            pose.insert(pose.end(), {2 + 1e-3 * static_cast<Real>(i), 0, 0.1, 0, 0, 0});
            force.insert(force.end(), {1e-6 * static_cast<Real>(i), 0, 0});
            weight.insert(weight.end(), {0, 0, -9.81});
        }
        const RolloutSettings run{
            .intervals = intervals,
            .dt = 2e-3,
            .controls = {{PoseControl{plate}, pose}, {BodyForceControl{ball}, force}, {GravityControl{}, weight}},
            .record = {{"ball", BodyProbe{ball}},
                       {"plate", PoseProbe{plate}},
                       {"force", BodyForceProbe{ball}},
                       {"energy", EnergyProbe{}},
                       {"nodes", NodesProbe{ball}}},
            .threads = 1};
        allocations = 0;
        counting = true;
        const RolloutResult result = rollout(world, 2, run);
        counting = false;
        REQUIRE(result.status[1].ok());
        return allocations.load();
    };
    // Tables of a copy grow when it has more contacts than before. One allocation per interval would be 400 more.
    CHECK(allocated(300) < allocated(100) + 40);
}

TEST_CASE("loads that change over time allocate nothing, either", "[determinism]") {
    World world = resting_balls(Backend::serial, 1);
    Loads loads(world);
    const TimeTable shake({{1.4, 0}, {1.45, 1}, {1.55, -1}, {1.6, 0}});
    loads.add(ForceLoad{world.bodies().front(), {0, 1}, {1e-3, 0, 0}, shake});
    loads.add(AccelerationField{.acceleration = {1e-2, 0, 0}, .scale = shake});
    loads.add(GravityScale{.scale = TimeTable({{1, 1}, {2, 0.9}})});
    loads.add(DragField{.rate = 1, .wind = {1e-2, 0, 0}, .scale = shake});
    REQUIRE(world.advance(1.5).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("leapfrog allocates nothing, either", "[determinism]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    World world = resting_balls(Backend::serial, 1, settings);
    const auto stiff = world.add_material({.young_modulus = 3e6, .friction = 0.5, .damping = 20});
    world.add_body(mesh::ball(0.05, 4), {.material = stiff, .position = {0.5, 0, 0.06}});
    REQUIRE(world.advance(1.5).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("a pile of balls on a cavity with gas allocates nothing, either", "[determinism]") {
    World world = resting_balls(Backend::serial, 1);
    const BodyHandle ball = world.bodies().front();
    Cavities cavities(world);
    const auto surface = world.surface(ball);
    const CavityHandle gas = cavities.add({.body = ball,
                                           .faces = std::vector(surface.begin(), surface.begin() + 2),
                                           .filling = GasFilling{.pressure = 10, .inflow = 1e-9},
                                           .volume = 1e-4});
    cavities.add({.first = gas, .conductance = 1e-12, .pressure = TimeTable({{0, 0}, {5, 20}})});
    REQUIRE(world.advance(1.5).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("cables allocate nothing, either", "[determinism]") {
    const auto dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    Settings settings = two_threads();
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e6});
    world.add_collider(Plane{});
    const BodyHandle block = world.add_body(mesh::box({0.2, 0.1, 0.1}, {4, 2, 2}),
                                            {.material = stiff, .position = {0, 0, 0.055}, .dynamics = dynamics});
    const std::vector<Anchor> points{
        {.point = {1, 0, 0}}, {.body = block, .point = {0, 0, 0.055}}, {.point = {0, 1, 0.2}}};
    Cables cables(world);
    cables.add({.points = points, .drive = {.tension = 1}});
    cables.add({.points = points, .drive = {.tension = 1}, .friction = 0.2});
    cables.add({.points = points, .drive = {.rate = -1e-4}});
    REQUIRE(world.advance(1).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("ties of each kind allocate nothing, either", "[determinism]") {
    const auto kind = GENERATE(TieKind::weld, TieKind::slide, TieKind::ball);
    const auto dynamics = GENERATE(BodyDynamics::explicit_elastic, BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    Settings settings = two_threads();
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e6});
    world.add_collider(Plane{});
    const Mesh mesh = mesh::box({0.2, 0.1, 0.1}, {4, 2, 2});
    const auto add = [&](Real x, BodyDynamics of) {
        return world.add_body(mesh, {.material = stiff, .position = {x, 0, 0.055}, .dynamics = of});
    };
    const BodyHandle left = add(0, BodyDynamics::explicit_elastic), right = add(0.2, dynamics);
    std::vector<Index> face;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].x() > 0.099) face.push_back(static_cast<Index>(n));
    Ties(world).add({.kind = kind, .body = left, .nodes = face, .to_body = right});
    REQUIRE(world.advance(1).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("surface sets and pairs of materials allocate nothing, either", "[determinism]") {
    Settings settings;
    settings.sleep = false;
    World world = resting_balls(Backend::serial, 1, settings);
    const MaterialHandle material = world.materials().front();
    SurfacePairs(world).set(material, material, {.restitution = 0});
    for (const BodyHandle body : world.bodies()) {
        std::vector<Index> nodes(world.positions(body).size());
        std::iota(nodes.begin(), nodes.end(), 0);
        SurfaceSets(world).add({.body = body,
                                .nodes = nodes,
                                .surface = {.friction = 0.4},
                                .friction_across = 0.2,
                                .direction = Vec3(1, 0, 0)});
    }
    REQUIRE(world.advance(1.5).ok());
    REQUIRE(world.contacts().front().friction_across < world.contacts().front().dynamic_friction);
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("rigid and implicit bodies at rest allocate nothing, either", "[determinism]") {
    const auto dynamics = GENERATE(BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    Settings settings = two_threads();
    settings.sleep = GENERATE(false, true);
    settings.gravity = {1, 0, -9};  // less steep than the friction angle
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e8, .friction = 0.3});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.1, 0.1}, {4, 2, 2});
    for (int i = 0; i < 4; ++i)
        world.add_body(block, {.material = stiff, .position = {0, 0.15 * i, 0.055 + 0.001 * i}, .dynamics = dynamics});
    do REQUIRE(world.advance(1).ok());
    while (settings.sleep && world.report().asleep < 4 && world.time() < 10);
    REQUIRE(world.report().asleep == (settings.sleep ? 4 : 0));
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("springs, dampers and fibres allocate nothing, either", "[determinism]") {
    Settings settings = two_threads();
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e6, .friction = 0.3, .damping = 20});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.1, 0.1}, {4, 2, 2});
    for (const BodyDynamics dynamics :
         {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic, BodyDynamics::rigid}) {
        const Real y = 0.15 * static_cast<Real>(dynamics);
        const BodyHandle body =
            world.add_body(block, {.material = stiff, .position = {0, y, 0.051}, .dynamics = dynamics});
        Springs(world).add({.first = {.body = body, .point = {0.1, y, 0.1}},
                            .second = {.point = {0.2, y, 1}},
                            .stiffness = 5,
                            .damping = 1,
                            .rest_length = TimeTable({{0, 0.9}, {10, 0.8}})});
        if (dynamics != BodyDynamics::rigid)
            Fibres(world).add({.body = body, .stiffness = 1e4, .tension = TimeTable({{0, 0}, {10, 1e4}})});
    }
    for (int k = 0; k < 10; ++k) REQUIRE(world.advance(0.2).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("joints that motors turn and that mimic others allocate nothing, either", "[determinism]") {
    Settings settings;
    settings.sleep = false;
    World world = resting_balls(Backend::serial, 1, settings);
    const auto stiff = world.add_material({});
    std::vector<JointHandle> hinges;
    for (const Real x : {3.0, 4.0}) {
        const BodyHandle body =
            world.add_body(mesh::box({0.2, 0.1, 0.1}, {2, 1, 1}),
                           {.material = stiff, .position = {x, 0, 1}, .dynamics = BodyDynamics::rigid});
        hinges.push_back(Joints(world).add({.kind = JointKind::hinge, .first = body, .point = {x, 0, 1}}));
    }
    Joints(world).set_motor(hinges[0], JointMotor{.speed = 1, .strength = 10});
    Joints(world).set_mimic(hinges[1], JointMimic{.leader = hinges[0], .ratio = -2});
    REQUIRE(world.advance(2).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
    CHECK(Joints(world).state(hinges[1]).speed == Approx(-2).epsilon(1e-3));
}

TEST_CASE("contacts of a block on rollers, under a traction on its present area, allocate nothing, either",
          "[determinism]") {
    Settings settings = two_threads();
    settings.sleep = false;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e6, .friction = 0.3, .damping = 20});
    const Mesh mesh = mesh::box({0.2, 0.2, 0.1}, {3, 3, 1});
    const BodyHandle block = world.add_body(mesh, {.material = stiff, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> all(mesh.nodes.size());
    std::iota(all.begin(), all.end(), Index{0});
    world.attach(block, all, {}, Vec3::Zero(), {Vec3::UnitZ()});
    const auto faces = world.surface(block);
    Loads(world).add(TractionLoad{
        .body = block, .faces = {faces.begin(), faces.end()}, .traction = {1, 0, 0}, .area = LoadArea::present});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = stiff, .position = {0.01, 0.02, 0.102}});
    for (int k = 0; k < 5; ++k) REQUIRE(world.advance(0.1).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("implicit bodies allocate nothing in steps that are longer than those of what lies on them",
          "[determinism]") {
    Settings settings = two_threads();
    settings.sleep = false;
    settings.step_size = 2e-4;
    settings.implicit_step = 2e-3;
    World world(settings);
    const auto stiff = world.add_material({.young_modulus = 1e8});
    const auto soft = world.add_material({.young_modulus = 1e5, .damping = 20});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {4, 4, 2});
    world.add_body(block, {.material = stiff, .position = {0, 0, 0.051}, .dynamics = BodyDynamics::implicit_elastic});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {.material = soft, .position = {0, 0, 0.155}});
    REQUIRE(world.advance(2).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
}

TEST_CASE("implicit bodies of large strain allocate nothing, whether they swing or lie", "[determinism]") {
    Settings settings = two_threads();
    settings.step_size = 1.0 / 240;
    settings.sleep = false;
    World world(settings);
    const auto soft = world.add_material({.young_modulus = 1e5, .friction = 0.5, .damping = 1});
    const Mesh bar = mesh::box({1, 0.1, 0.1}, {6, 1, 1});
    const auto hangs =
        world.add_body(bar, {.material = soft, .position = {0, 0, 2}, .dynamics = BodyDynamics::implicit_elastic});
    std::vector<Index> held;
    for (std::size_t n = 0; n < bar.nodes.size(); ++n)
        if (bar.nodes[n].x() < -0.5 + 1e-9) held.push_back(static_cast<Index>(n));
    world.attach(hangs, held);
    world.add_body(mesh::box({0.4, 0.4, 0.4}, {3, 3, 3}),
                   {.material = world.add_material({.young_modulus = 1e4, .damping = 20}),
                    .position = {3, 0, 0.21},
                    .dynamics = BodyDynamics::implicit_elastic});
    world.add_collider(Plane{});
    REQUIRE(world.advance(2).ok());
    const std::uint64_t before = world.report().large_strain_steps;
    CHECK(allocations_of_a_fifth_second(world) == 0);
    CHECK(world.report().large_strain_steps >= before + 90);
}

TEST_CASE("bodies at rest beside one that moves allocate nothing, either", "[determinism]") {
    World world = resting_balls(Backend::serial, 1, {}, {.sleep_speed = 0.01});
    do REQUIRE(world.advance(0.5).ok());
    while (world.report().asleep < 6 && world.time() < 40);
    REQUIRE(world.report().asleep == 6);
    const auto rolling = world.add_body(
        mesh::ball(0.05, 4),
        {.material = world.add_material({.friction = 0.5}), .position = {1, 0, 0.05}, .velocity = {1, 0, 0}});
    REQUIRE(world.advance(0.5).ok());
    CHECK(allocations_of_a_fifth_second(world) == 0);
    CHECK_FALSE(world.asleep(rolling));
    CHECK(world.report().asleep == 6);
}

TEST_CASE("measuring forces allocates nothing, either, and nor do bodies that it follows into their rest",
          "[determinism]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    for (const Real sleep_speed : {0.0, 0.01}) {
        World world = resting_balls(Backend::serial, 1, settings, {.sleep_speed = sleep_speed});
        const auto held =
            world.add_body(mesh::ball(0.05, 4), {.material = world.add_material({}), .position = {1, 0, 1}});
        world.attach(held, std::vector<Index>{0, 1, 2});
        world.measure_forces(true);
        do REQUIRE(world.advance(1.5).ok());
        while (sleep_speed > 0 && world.report().asleep == 0 && world.time() < 20);
        allocations = 0;
        counting = true;
        REQUIRE(world.advance(0.2).ok());
        counting = false;
        CHECK(allocations == 0);
        CHECK(world.forces().pairs().size() >= 6);
        CHECK((world.report().asleep > 0) == (sleep_speed > 0));
    }
}

TEST_CASE(
    "a control loop that sets velocities and targets, asks and is called back in each millisecond allocates nothing",
    "[determinism]") {
    World world({.backend = Backend::serial, .threads = 1});
    const auto rubber = world.add_material({.young_modulus = 3e4, .friction = 0.8, .damping = 20});
    world.add_collider(Plane{});
    const auto ball = world.add_body(mesh::ball(0.05, 6), {.material = rubber, .position = {0, 0, 0.052}});
    const auto pad = world.add_body(mesh::box({0.02, 0.05, 0.05}, {1, 2, 2}),
                                    {.material = rubber, .position = {-0.063, 0, 0.055}, .name = "pad"});
    const auto hold = world.attach(pad, std::vector<Index>{0, 3, 6, 9, 12, 15});
    const auto finger = world.add_collider(Box{{0.02, 0.05, 0.05}}, {.position = {0.063, 0, 0.055}});
    const auto mesh_finger =
        world.add_collider(mesh::boundary(mesh::box({0.05, 0.02, 0.05}, {1, 1, 1})), {.position = {0, 0.063, 0.055}});
    Real force = 0;
    world.watch_steps([&](const StepReport&) {
        for (const Contact& contact : world.contacts()) force += contact.impulse.norm();
    });
    const std::vector<Vec3> load(world.positions(ball).size(), Vec3(0, 0, -1e-3));
    const auto control = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            const Real turn = 0.01 * i;
            world.set_velocity(finger, {-0.02 * std::sin(turn), 0, 0}, {0, 0, 0.01});
            world.set_velocity(hold, {0.02 * std::sin(turn), 0, 0});
            world.move_to(mesh_finger, {{0, 0.0625 - 0.001 * std::sin(turn), 0.055}, {0, 0, 0}}, 1e-3);
            world.set_loads(ball, load);
            (void)world.nearest_point({0, 0, 0.2}, 1);
            if (!world.advance(1e-3).ok()) return false;
        }
        return true;
    };
    REQUIRE(control(0, 2000));
    const std::uint64_t searches = world.report().broad_searches;
    allocations = 0;
    counting = true;
    const bool went_well = control(2000, 2600);
    counting = false;
    CHECK(went_well);
    CHECK(allocations == 0);
    CHECK(world.report().broad_searches < searches + 60);  // broad searches are as rare as without control
    CHECK(force > 0);
}

TEST_CASE("the memory that bodies take while they are added grows with their number, not with its square",
          "[determinism]") {
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const auto bytes_of = [&](int bodies) {
        World world;
        const auto rubber = world.add_material({});
        bytes = 0;
        counting = true;
        for (int i = 0; i < bodies; ++i) world.add_body(cube, {.material = rubber, .position = {0.2 * i, 0, 1}});
        REQUIRE(world.stable_step() > 0);
        counting = false;
        return static_cast<double>(bytes.load());
    };
    const double few = bytes_of(400);
    // Doubling columns may take up to twice as much. Tables rebuilt for each body would take 16 times as much.
    CHECK(bytes_of(1600) < 6 * few);
}

}  // namespace skerry::test::determinism_allocation_test
