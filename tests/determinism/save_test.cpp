// A world that was copied, or saved and loaded, continues with the same bits in its state and the same report as the
// original, on any backend and number of threads.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "engine/world/tuning.h"
#include "engine/world/world_state.h"
#include "skerry/scene.h"
#include "tests/support/crossing_ring.h"
#include "tests/support/lively_scene.h"
#include "tests/support/mapped_box.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::save_test {

namespace {

/// A start world, and the calls of advance() that are made on it.
struct Course {
    std::function<World()> start;
    Real call;  // s
    int calls;
};

Course scene(const char* name, Real call, int calls) {
    return {[name] { return load_scene(std::string(SKERRY_SOURCE_DIR) + "/scenes/" + name).world; }, call, calls};
}

Course lively(Integrator integrator, int calls) {
    Settings settings;
    settings.integrator = integrator;
    return {[settings] { return lively_scene(settings); }, 0.0107, calls};
}

void check_same_report(const WorldReport& a, const WorldReport& b) {
    CHECK(a.time == b.time);
    CHECK(a.steps == b.steps);
    CHECK(a.inline_steps == b.inline_steps);
    CHECK(a.shortened == b.shortened);
    CHECK(a.retried == b.retried);
    CHECK(a.contact_sum == b.contact_sum);
    CHECK(a.iteration_sum == b.iteration_sum);
    CHECK(a.certified == b.certified);
    CHECK(a.max_penetration == b.max_penetration);
    CHECK(a.asleep == b.asleep);
    CHECK(a.clusters == b.clusters);
    CHECK(a.stable_step == b.stable_step);
    // The counts of searches also match the run without a restart.
    CHECK(a.broad_searches == b.broad_searches);
    CHECK(a.pair_searches == b.pair_searches);
    CHECK(a.candidates == b.candidates);
    CHECK(a.crossing_tests == b.crossing_tests);
    CHECK(a.energy.dissipated == b.energy.dissipated);
    CHECK(a.energy_error == b.energy_error);
    CHECK(a.energy_error_share == b.energy_error_share);
    CHECK((a.momentum_error == b.momentum_error || (std::isnan(a.momentum_error) && std::isnan(b.momentum_error))));
    CHECK(a.balanced_steps == b.balanced_steps);
    REQUIRE(a.self_crossings.size() == b.self_crossings.size());
    for (std::size_t i = 0; i < a.self_crossings.size(); ++i) {
        const SelfCrossing &one = a.self_crossings[i], &other = b.self_crossings[i];
        CHECK(one.body.slot == other.body.slot);
        CHECK(one.name == other.name);
        CHECK(one.self_contact == other.self_contact);
        CHECK(one.first_time == other.first_time);
        CHECK(one.last_time == other.last_time);
        CHECK(one.last_places == other.last_places);
        CHECK(one.most_places == other.most_places);
    }
    REQUIRE(a.step_limits.size() == b.step_limits.size());
    for (std::size_t i = 0; i < a.step_limits.size(); ++i) {
        CHECK(a.step_limits[i].body.slot == b.step_limits[i].body.slot);  // world numbers differ between runs
        CHECK(a.step_limits[i].body_name == b.step_limits[i].body_name);
        CHECK(a.step_limits[i].steps == b.step_limits[i].steps);
        CHECK(a.step_limits[i].seconds == b.step_limits[i].seconds);
    }
}

void check_same_contacts(std::span<const Contact> a, std::span<const Contact> b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t c = 0; c < a.size(); ++c) {
        CHECK(a[c].first == b[c].first);
        CHECK(a[c].second == b[c].second);
        CHECK(a[c].collider == b[c].collider);
        CHECK(a[c].impulse == b[c].impulse);
        CHECK(a[c].node == b[c].node);
        CHECK(a[c].region == b[c].region);
    }
}

/// Saves at `moments` random calls of the course. Continues the first file to the end, and the others for `on` calls.
void check_restarts(const Course& course, int moments, int on, std::uint64_t seed) {
    const TemporaryFolder folder;
    const auto file = [&](int call) { return folder.path() / (std::to_string(call) + ".skerry"); };
    Random random(seed);
    std::vector<char> saved_at(static_cast<std::size_t>(course.calls), 0);
    for (int i = 0; i < moments; ++i)
        saved_at[static_cast<std::size_t>((random.number() + 1) / 2 * static_cast<Real>(course.calls))] = 1;
    std::vector<std::uint64_t> hash;
    std::vector<WorldReport> report;
    World world = course.start();
    for (int call = 0; call < course.calls; ++call) {
        if (saved_at[static_cast<std::size_t>(call)]) world.save(file(call));
        REQUIRE(world.advance(course.call).ok());
        hash.push_back(world.state_hash());
        report.push_back(world.report());
    }
    // Saving does not change the run.
    World other = course.start();
    for (int call = 0; call < course.calls; ++call) REQUIRE(other.advance(course.call).ok());
    CHECK(other.state_hash() == hash.back());
    check_same_report(other.report(), report.back());

    const std::vector<Backend> backends(available_backends().begin(), available_backends().end());
    int restart = 0;
    for (int call = 0; call < course.calls; ++call) {
        if (!saved_at[static_cast<std::size_t>(call)]) continue;
        CAPTURE(call, restart);
        const Backend backend = backends[static_cast<std::size_t>(restart) % backends.size()];
        World loaded = World::load(file(call), {.backend = backend, .threads = 1 + restart % 4});
        ++restart;
        if (call > 0) check_same_report(loaded.report(), report[static_cast<std::size_t>(call) - 1]);
        const int end = restart == 1 ? course.calls : std::min(course.calls, call + on);
        for (int k = call; k < end; ++k) {
            REQUIRE(loaded.advance(course.call).ok());
            REQUIRE(loaded.state_hash() == hash[static_cast<std::size_t>(k)]);
        }
        check_same_report(loaded.report(), report[static_cast<std::size_t>(end - 1)]);
    }
}

}  // namespace

TEST_CASE("skittles restarted at ten random moments go on with the bits of the run that was not",
          "[determinism][slow]") {
    check_restarts(scene("skittles.json", 1.0 / 60, 60), 10, 6, 1);
}

TEST_CASE("a bucket of balls restarted at ten random moments goes on with the bits of the run that was not",
          "[determinism][slow]") {
    check_restarts(scene("bucket.json", 1.0 / 60, 40), 10, 4, 2);
}

TEST_CASE("meshes from files restarted at ten random moments go on with the bits of the run that was not",
          "[determinism][slow]") {
    check_restarts(scene("mesh_drop.json", 1.0 / 60, 30), 10, 4, 3);
}

// The scene has sleep, a moving mesh collider, held nodes, loads and several materials.
TEST_CASE("sleeping bodies restarted at ten random moments go on with the bits of the run that was not",
          "[determinism][slow]") {
    check_restarts(lively(Integrator::symplectic_euler, 50), 10, 8, 4);
}

TEST_CASE("leapfrog restarted at ten random moments goes on with the bits of the run that was not",
          "[determinism][slow]") {
    check_restarts(lively(Integrator::leapfrog, 40), 10, 8, 5);
}

TEST_CASE("clusters restarted at five random moments go on with the bits of the run that was not",
          "[determinism][clusters]") {
    check_restarts({[] { return thrown_slivers(); }, 0.003, 12}, 5, 4, 6);
}

TEST_CASE("leapfrog, global regions and a set step are saved", "[determinism]") {
    Settings settings;
    settings.integrator = Integrator::leapfrog;
    settings.contact_regions = ContactRegions::global;
    settings.method = SolverMethod::pgs;
    settings.step_size = 1e-4;
    settings.clusters = false;
    const auto start = [settings] {
        World world(settings);
        world.add_collider(Plane{});
        world.add_body(
            mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
            {.material = world.add_material({.young_modulus = 2e4, .damping = 100}), .position = {0, 0, 0.06}});
        return world;
    };
    check_restarts({start, 0.01, 6}, 3, 6, 7);
}

TEST_CASE("a clone goes on with the same bits, and neither changes the other", "[determinism][serial]") {
    World world = lively_scene({});
    REQUIRE(world.advance(0.1).ok());
    const std::uint64_t before = world.state_hash();
    World copy = world.clone();
    CHECK(copy.state_hash() == before);
    check_same_report(copy.report(), world.report());
    check_same_contacts(copy.contacts(), world.contacts());
    REQUIRE(copy.advance(0.05).ok());
    CHECK(world.state_hash() == before);
    REQUIRE(world.advance(0.05).ok());
    CHECK(copy.state_hash() == world.state_hash());
    check_same_report(copy.report(), world.report());
    check_same_contacts(copy.contacts(), world.contacts());
}

TEST_CASE("a clone with other threads and another backend goes on with the same bits", "[determinism]") {
    World world = lively_scene({}, 2);
    REQUIRE(world.advance(0.1).ok());
    World copy = world.clone({.backend = Backend::serial, .threads = 1});
    CHECK(WorldAccess::state_of(copy).executor->worker_count() == 1);
    CHECK(copy.settings().backend == Backend::serial);
    CHECK(copy.settings().threads == 1);
    CHECK(world.clone().settings().threads == 2);
    CHECK_THROWS_WITH(world.clone({.threads = -1}), Catch::Contains("threads") && Catch::Contains("-1"));
    REQUIRE(copy.advance(0.05).ok());
    REQUIRE(world.advance(0.05).ok());
    CHECK(copy.state_hash() == world.state_hash());
    check_same_report(copy.report(), world.report());
}

TEST_CASE("settings that users do not have are carried by clones and files", "[determinism]") {
    const Tuning tuning{.step_safety = 0.5,
                        .max_strain_step = 0.3,
                        .restitution_speed = 0.1,
                        .sleep_speed = 0.2,
                        .contact_budgets = false,
                        .warm_start = WarmStart::off,
                        .fixed_iterations = true,
                        .relaxation = 0.9,
                        .certify_warm_start = false,
                        .skip_separating = false,
                        .frictionless_rows = false,
                        .small_regions_in_lanes = false};
    const TemporaryFolder folder;
    const World world = tuned_world({}, tuning);
    world.save(folder.path() / "world.skerry");
    const World loaded = World::load(folder.path() / "world.skerry"), copy = world.clone();
    for (const World* other : {&loaded, &copy}) {
        const WorldState& state = WorldAccess::state_of(*other);
        CHECK(state.model.tuning == tuning);
        CHECK(state.scratch.parameters.solver == solver_settings({}, tuning));
    }
}

TEST_CASE("a loaded world has the same handles, names, shapes and contacts", "[determinism][serial]") {
    const TemporaryFolder folder;
    World world = lively_scene({});
    const std::vector<BodyHandle> all = world.bodies();
    world.remove(all[1]);
    world.remove(world.colliders()[1]);
    const BodyHandle late = world.add_body(
        mesh::ball(0.05, 3), {.material = MaterialHandle{0, 0, all[0].world}, .position = {0, 0, 2}, .name = "late"});
    REQUIRE(world.advance(0.05).ok());
    world.save(folder.path() / "world.skerry");
    World loaded = World::load(folder.path() / "world.skerry");
    CHECK(loaded.bodies() == world.bodies());
    CHECK(loaded.colliders() == world.colliders());
    CHECK_FALSE(loaded.alive(all[1]));
    CHECK(loaded.name(late) == "late");
    CHECK(loaded.settings().sleep_time == world.settings().sleep_time);
    for (const BodyHandle body : world.bodies()) {
        CHECK(loaded.element(body) == world.element(body));
        CHECK(std::ranges::equal(loaded.surface(body), world.surface(body)));
        CHECK(std::ranges::equal(loaded.positions(body), world.positions(body)));
        CHECK(loaded.mass(body) == world.mass(body));
        CHECK(loaded.stress(body) == world.stress(body));
        CHECK(loaded.tetrahedron_steps(body) == world.tetrahedron_steps(body));
    }
    for (const ColliderHandle collider : world.colliders()) {
        CHECK(loaded.shape(collider).index() == world.shape(collider).index());
        CHECK(loaded.pose(collider).position == world.pose(collider).position);
        CHECK(loaded.name(collider) == world.name(collider));
    }
    check_same_contacts(loaded.contacts(), world.contacts());
    // Edits change both worlds in the same way.
    for (World* w : {&world, &loaded}) {
        w->remove(late);
        w->add_collider(Sphere{0.1}, {.position = {0, 0, -1}});
        w->set_gravity({0, 1, -9});
        REQUIRE(w->advance(0.02).ok());
    }
    CHECK(loaded.state_hash() == world.state_hash());
    CHECK(loaded.bodies() == world.bodies());
}

TEST_CASE("a world is saved before its first step, empty, and with nothing but a plane", "[determinism]") {
    const TemporaryFolder folder;
    const auto file = folder.path() / "world.skerry";
    World empty;
    empty.save(file);
    CHECK(World::load(file).state_hash() == empty.state_hash());
    World plane;
    plane.add_collider(Plane{});
    plane.save(file);
    World loaded = World::load(file);
    CHECK(loaded.colliders() == plane.colliders());
    REQUIRE(loaded.advance(0.1).ok());
    World fresh = lively_scene({});
    fresh.save(file);
    World restarted = World::load(file);
    REQUIRE(fresh.advance(0.02).ok());
    REQUIRE(restarted.advance(0.02).ok());
    CHECK(restarted.state_hash() == fresh.state_hash());
    check_same_report(restarted.report(), fresh.report());
}

TEST_CASE("equal meshes are saved once", "[determinism]") {
    const TemporaryFolder folder;
    const auto bytes = [&](Real second_radius) {
        World world;
        const auto rubber = world.add_material({});
        world.add_body(mesh::ball(0.1, 8), {.material = rubber});
        world.add_body(mesh::ball(second_radius, 8), {.material = rubber, .position = {1, 0, 0}});
        world.save(folder.path() / "world.skerry");
        return std::filesystem::file_size(folder.path() / "world.skerry");
    };
    const Mesh ball = mesh::ball(0.1, 8);
    const std::size_t of_mesh = sizeof(ball.nodes[0]) * ball.nodes.size() + 16 * ball.tetrahedra.size();
    CHECK(bytes(0.1) + of_mesh < bytes(0.11));
}

TEST_CASE("a body that folds onto itself goes on with the bits and the searches of the run that was not saved",
          "[determinism]") {
    const auto start = [] {
        Settings settings;
        settings.gravity = Vec3::Zero();
        World world(settings);
        const Mesh sheet = mesh::box({0.2, 0.06, 0.01}, {16, 4, 1});
        const auto rubber = world.add_material({.young_modulus = 1e5, .poisson_ratio = 0.3, .damping = 30});
        const BodyHandle body = world.add_body(sheet, {.material = rubber, .self_contact = true});
        world.attach(body, nodes_where(sheet, [](const Vec3& x) { return x.x() < -0.091; }));
        world.attach(body, nodes_where(sheet, [](const Vec3& x) { return x.x() > 0.091; }),
                     {.angular_velocity = {0, -17, 0}}, {0, 0, 0.012});
        return world;
    };
    check_restarts({start, 0.0107, 15}, 6, 4, 9);
}

TEST_CASE("a saved world knows which body has crossed itself", "[determinism]") {
    const TemporaryFolder folder;
    CrossingRing ring;
    ring.close();
    REQUIRE(ring.world.advance(0.6).ok());
    ring.open();
    ring.world.save(folder.path() / "ring.skerry");
    const WorldReport report = World::load(folder.path() / "ring.skerry").report();
    REQUIRE(report.self_crossings.size() == 1);
    CHECK(report.self_crossings[0].body == ring.body);
    check_same_report(report, ring.world.report());
}

}  // namespace skerry::test::save_test
