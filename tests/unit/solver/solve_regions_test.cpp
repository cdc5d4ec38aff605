#include "systems/solver/solve_regions.h"

#include <catch2/catch.hpp>
#include <limits>
#include <numbers>

#include "tests/support/contact_scene.h"

namespace skerry::test::solve_regions_test {

namespace {

SolverSettings exact() {
    SolverSettings settings;
    settings.tolerance = 1e-12;
    settings.max_iterations = 100000;
    settings.warm_start = WarmStart::off;
    return settings;
}

/// Pairs of sheets, each sheet a separate body. In every third pair both sheets are still, in every third only the
/// first, and in every third the first is still on a moving collider.
struct StillSheets {
    static constexpr int pairs = 18;
    ContactScene scene;
    std::vector<Index> first, second;
    std::vector<BodyKind> kind;
    std::vector<Real> still_time;

    StillSheets() {
        for (int k = 0; k < pairs; ++k) {
            add_sheets(scene, 3 + k % 6, 0.5, static_cast<unsigned>(k));
            first.resize(scene.stencil.size(), 2 * k);
            second.resize(scene.stencil.size(), k % 4 == 0 ? no_index : 2 * k + 1);
            kind.push_back(BodyKind::deformable);
            kind.push_back(k % 3 == 2 ? BodyKind::kinematic : BodyKind::deformable);
            still_time.push_back(1e-3);
            still_time.push_back(k % 3 == 0 ? 0.2 : 0);
        }
    }
    static bool still(int pair) { return pair % 3 != 1 || pair % 4 == 0; }
    SolvedScene solve(const SolverSettings& settings) const {
        SolvedScene result = scene.solve(settings);
        result.impulse = scene.impulse;
        result.velocity = scene.velocity;
        RegionInputs inputs = scene.inputs();
        inputs.first_body = first;
        inputs.second_body = second;
        inputs.body_kind = kind;
        inputs.still_time = still_time;
        SolverMemory memory;
        const auto executor = make_executor(Backend::threads, 2);
        solve_regions(*executor, inputs, settings, scene.h, memory, result.regions,
                      {result.impulse, result.velocity, result.push_out});
        return result;
    }
};

}  // namespace

TEST_CASE("no contacts are skipped", "[unit][solver]") {
    ContactScene scene;
    scene.add_node(1, Vec3(1, 2, 3));
    RegionTable regions;
    SolverMemory memory;
    std::vector<Vec3> velocity = scene.velocity, push(1);
    const auto executor = make_executor(Backend::serial, 1);
    CHECK_FALSE(solve_regions(*executor, scene.inputs(), {}, scene.h, memory, regions, {{}, velocity, push}));
    CHECK(velocity == scene.velocity);
}

TEST_CASE("a point mass sticks inside the cone and slides on it", "[unit][solver]") {
    ContactScene scene;
    const Index node = scene.add_node(2, Vec3(0.3, 0.4, -2));
    scene.touch_floor(node, 0.5);
    const SolvedScene stuck = scene.solve();
    CHECK((stuck.impulse[0] - Vec3(-0.6, -0.8, 4)).norm() < 1e-14);
    CHECK(stuck.velocity[0].norm() < 1e-15);

    scene.velocity[0] = scene.velocity_before[0] = Vec3(3, 4, -2);  // friction takes 0.5 * 2 m/s of 5 m/s
    const SolvedScene sliding = scene.solve();
    CHECK((sliding.velocity[0] - Vec3(2.4, 3.2, 0)).norm() < 1e-14);
    CHECK((sliding.impulse[0] - Vec3(-1.2, -1.6, 4)).norm() < 1e-14);
    CHECK(sliding.regions.status[0] == RegionStatus::converged);
    // The dissipated energy is all kinetic energy that was lost.
    CHECK(sliding.regions.dissipated[0] == Approx(0.5 * 2 * (29 - 16)).epsilon(1e-13));
}

TEST_CASE("static friction holds a contact that dynamic friction would not hold", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0.45, 0, -1)), 0.5);
    scene.dynamic_friction[0] = 0.2;
    CHECK(scene.solve().velocity[0].norm() < 1e-15);
    scene.velocity[0] = Vec3(0.55, 0, -1);
    CHECK((scene.solve().velocity[0] - Vec3(0.35, 0, 0)).norm() < 1e-15);
}

TEST_CASE("a gap may close within the step and no further", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0, 0, -2)), 0.5);
    scene.gap[0] = 1.5e-3;  // 1.5 m/s closes it
    CHECK((scene.solve().velocity[0] - Vec3(0, 0, -1.5)).norm() < 1e-14);
    scene.gap[0] = 3e-3;
    CHECK(scene.solve().velocity[0] == Vec3(0, 0, -2));
    CHECK(scene.solve().impulse[0] == Vec3::Zero());
}

TEST_CASE("the velocities of a collider and of a kinematic node enter the contact velocity", "[unit][solver]") {
    ContactScene scene;
    const Index node = scene.add_node(1, Vec3(0, 0, 0));
    scene.touch_floor(node, 10);
    scene.surface_velocity[0] = Vec3(1, 0, 2);  // a conveyor that rises
    CHECK((scene.solve().velocity[0] - Vec3(1, 0, 2)).norm() < 1e-15);

    ContactScene pushed;
    const Index mass = pushed.add_node(1, Vec3::Zero()), plate = pushed.add_node(0, Vec3(1, 0, 2));
    pushed.touch_node(mass, plate, Vec3::UnitZ(), 10);
    const SolvedScene solved = pushed.solve();
    CHECK((solved.velocity[0] - Vec3(1, 0, 2)).norm() < 1e-15);
    CHECK(solved.velocity[1] == Vec3(1, 0, 2));
}

TEST_CASE("a bounce returns the restitution's share, and only fast impacts bounce", "[unit][solver]") {
    ContactScene scene;
    scene.touch_floor(scene.add_node(1, Vec3(0, 0, -2)), 0);
    scene.restitution[0] = 0.6;
    scene.velocity[0] = Vec3(0, 0, -2 - scene.gravity * scene.h);
    CHECK(scene.solve().velocity[0].z() == Approx(1.2).epsilon(1e-14));
    scene.gap[0] = 3e-3;  // not reached in this step
    CHECK(scene.solve().velocity[0] == scene.velocity[0]);
    scene.gap[0] = 0;
    scene.velocity_before[0] = scene.velocity[0] = Vec3(0, 0, -0.04);  // below restitution_speed
    CHECK(std::abs(scene.solve().velocity[0].z()) < 1e-16);
    scene.gap[0] = 0;
    scene.velocity_before[0] = Vec3(0, 0, -0.2);
    scene.velocity[0] = Vec3(0, 0, -0.25);  // forces add less than half of the approach speed
    CHECK(scene.solve().velocity[0].z() == Approx(0.12).epsilon(1e-14));
    scene.velocity[0] = Vec3(0, 0, -0.4);  // forces of one step could have caused this speed: not an impact
    CHECK(std::abs(scene.solve().velocity[0].z()) < 1e-16);
}

TEST_CASE("the lowest contact of a stack of point masses carries them all", "[unit][solver]") {
    constexpr int height = 8;
    ContactScene scene;
    const Real fall = scene.gravity * scene.h;
    for (int i = 0; i < height; ++i) {
        const Index node = scene.add_node(0.5 + i, Vec3(0, 0, -fall));
        if (i == 0) {
            scene.touch_floor(node, 0.5);
        } else {
            scene.touch_node(node, node - 1, Vec3::UnitZ(), 0.5);
        }
    }
    const SolvedScene solved = scene.solve(exact());
    REQUIRE(solved.regions.size() == 1);
    CHECK(solved.regions.status[0] == RegionStatus::converged);
    Real above = 0;
    for (int i = height - 1; i >= 0; --i) {
        above += 0.5 + i;
        CHECK(solved.impulse[static_cast<std::size_t>(i)].z() == Approx(above * fall).epsilon(1e-9));
        CHECK(solved.velocity[static_cast<std::size_t>(i)].norm() < 1e-9 * fall * height);
    }
}

TEST_CASE("a mass that runs into a chain takes it along", "[unit][solver]") {
    constexpr int length = 6;
    ContactScene scene;
    for (int i = 0; i < length; ++i) {
        const Index node = scene.add_node(1, i == 0 ? Vec3(3, 0, 0) : Vec3(0, 0, 0));
        if (i > 0) scene.touch_node(node, node - 1, Vec3::UnitX(), 0);
    }
    const SolvedScene solved = scene.solve(exact());
    for (const Vec3& v : solved.velocity) CHECK((v - Vec3(3.0 / length, 0, 0)).norm() < 1e-10);
}

TEST_CASE("a frictionless impact takes energy out and conserves momentum", "[property][solver]") {
    for (unsigned seed = 0; seed < 20; ++seed) {
        ContactScene scene;
        add_sheets(scene, 6, seed % 2 == 0 ? 0 : 0.5, seed);
        const SolvedScene solved = scene.solve(exact());
        REQUIRE(solved.regions.status[0] == RegionStatus::converged);
        REQUIRE(scene.kinetic_energy(solved.velocity) < scene.kinetic_energy(scene.velocity));
        CHECK(solved.regions.dissipated[0] ==
              Approx(scene.kinetic_energy(scene.velocity) - scene.kinetic_energy(solved.velocity)).epsilon(1e-10));
        Vec3 change = Vec3::Zero();
        for (std::size_t n = 0; n < solved.velocity.size(); ++n)
            change += (solved.velocity[n] - scene.velocity[n]) / scene.inverse_mass[n];
        CHECK(change.norm() < 1e-12);
        for (std::size_t i = 0; i < scene.stencil.size(); ++i)
            CHECK(scene.relative_velocity(i, solved.velocity).dot(scene.normal[i]) > -1e-9);
    }
}

TEST_CASE("a solved region obeys Coulomb's law contact by contact", "[property][solver]") {
    ContactScene scene;
    add_sheets(scene, 8, 0.4, 5);
    const SolvedScene solved = scene.solve(exact());
    REQUIRE(solved.regions.status[0] == RegionStatus::converged);
    for (std::size_t i = 0; i < scene.stencil.size(); ++i) {
        const Vec3 u = scene.relative_velocity(i, solved.velocity), r = solved.impulse[i], n = scene.normal[i];
        const Vec3 slip = u - u.dot(n) * n, friction = r - r.dot(n) * n;
        CHECK(r.dot(n) >= 0);
        CHECK(u.dot(n) * r.dot(n) < 1e-9);
        CHECK(friction.norm() <= 0.4 * r.dot(n) + 1e-12);
        CHECK(std::abs(friction.dot(slip) + 0.4 * r.dot(n) * slip.norm()) < 1e-9);  // opposite, and full when it slides
    }
}

TEST_CASE("without friction the sweep is scalar Gauss-Seidel", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 6, 0, 9);
    SolverSettings settings;
    settings.method = SolverMethod::pgs;
    settings.fixed_iterations = true;
    settings.max_iterations = 25;
    settings.warm_start = WarmStart::off;
    const SolvedScene solved = scene.solve(settings);

    std::vector<Vec3> v = scene.velocity;
    std::vector<Real> r(scene.stencil.size(), 0);
    for (int sweep = 0; sweep < 25; ++sweep)
        for (std::size_t i = 0; i < r.size(); ++i) {
            Real diagonal = 0;
            for (std::size_t a = 0; a < 4; ++a)
                diagonal += std::pow(scene.stencil[i].weight[a], 2) *
                            scene.inverse_mass[static_cast<std::size_t>(scene.stencil[i].node[a])];
            const Real next = std::max(0.0, r[i] - scene.relative_velocity(i, v).dot(scene.normal[i]) / diagonal);
            for (std::size_t a = 0; a < 4; ++a) {
                const auto node = static_cast<std::size_t>(scene.stencil[i].node[a]);
                v[node] += scene.stencil[i].weight[a] * scene.inverse_mass[node] * (next - r[i]) * scene.normal[i];
            }
            r[i] = next;
        }
    for (std::size_t i = 0; i < r.size(); ++i) CHECK((solved.impulse[i] - r[i] * scene.normal[i]).norm() < 1e-13);
    for (std::size_t n = 0; n < v.size(); ++n) CHECK((solved.velocity[n] - v[n]).norm() < 1e-13);
}

TEST_CASE("the pyramid brakes more along its diagonal, the cone the same everywhere", "[unit][solver]") {
    for (int k = 0; k < 16; ++k) {
        const Real angle = k * std::numbers::pi / 8 + 0.1;
        ContactScene scene;
        scene.touch_floor(scene.add_node(1, Vec3(20 * std::cos(angle), 20 * std::sin(angle), -1)), 0.5);
        SolverSettings settings;
        const Vec3 cone = scene.solve(settings).impulse[0];
        CHECK((cone - Vec3(-0.5 * std::cos(angle), -0.5 * std::sin(angle), 1)).norm() < 1e-14);
        settings.friction = Friction::pyramid;  // docs/accuracy.md, item 28: mu N (sgn cos, sgn sin)
        const Vec3 pyramid = scene.solve(settings).impulse[0];
        CHECK((pyramid - Vec3(std::copysign(0.5, -std::cos(angle)), std::copysign(0.5, -std::sin(angle)), 1)).norm() <
              1e-14);
        CHECK(pyramid.head<2>().norm() == Approx(std::numbers::sqrt2 * cone.head<2>().norm()));
    }
}

TEST_CASE("a hundred copies of a contact act like one", "[unit][solver]") {
    ContactScene one, many;
    for (ContactScene* scene : {&one, &many}) {
        scene->add_node(1, Vec3(2, 0.3, -1));
        for (int k = 0; k < (scene == &one ? 1 : 100); ++k) scene->touch_floor(0, 0.4);
    }
    const SolvedScene single = one.solve(exact()), repeated = many.solve(exact());
    REQUIRE(repeated.regions.status[0] == RegionStatus::converged);
    CHECK((repeated.velocity[0] - single.velocity[0]).norm() < 1e-10);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& r : repeated.impulse) sum += r;
    CHECK((sum - single.impulse[0]).norm() < 1e-10);
}

TEST_CASE("more contacts than freedoms still give velocities that separate", "[unit][solver]") {
    ContactScene scene;
    const Index node = scene.add_node(1, Vec3(0.2, -0.1, -1));
    for (int k = 0; k < 12; ++k) {
        const Real angle = 0.5 * k;
        scene.touch({{node, node, node, node}, {1, 0, 0, 0}}, Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), 1),
                    0.3);
    }
    const SolvedScene solved = scene.solve(exact());
    CHECK(solved.regions.status[0] == RegionStatus::converged);
    for (std::size_t i = 0; i < scene.stencil.size(); ++i) CHECK(solved.velocity[0].dot(scene.normal[i]) > -1e-9);
}

TEST_CASE("a warm start that solves the region needs no sweep", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 6, 0.5, 2);
    SolverSettings settings;
    settings.tolerance = 1e-6;
    settings.max_iterations = 10000;
    const SolvedScene first = scene.solve(settings);
    REQUIRE(first.regions.status[0] == RegionStatus::converged);
    scene.impulse = first.impulse;
    const SolvedScene second = scene.solve(settings);
    CHECK(second.regions.status[0] == RegionStatus::certified);
    CHECK(second.regions.iterations[0] == 0);
    CHECK(second.impulse == first.impulse);
    for (std::size_t n = 0; n < first.velocity.size(); ++n)
        CHECK((second.velocity[n] - first.velocity[n]).norm() < 1e-12);

    settings.warm_start = WarmStart::off;
    const SolvedScene cold = scene.solve(settings);
    CHECK(cold.regions.iterations[0] == first.regions.iterations[0]);
}

TEST_CASE("a warm start of another world is not worse than none", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 6, 0.5, 2);
    SolverSettings settings;
    settings.tolerance = 1e-6;
    settings.max_iterations = 10000;
    const Index cold = scene.solve(settings).regions.iterations[0];
    for (Vec3& r : scene.impulse) r = Vec3(1e6, 0, 1e6);
    const SolvedScene misled = scene.solve(settings);
    CHECK(misled.regions.iterations[0] == cold);
    CHECK(misled.regions.status[0] == RegionStatus::converged);
}

TEST_CASE("a region in which nothing moves and nothing weighs has no impulse and no error, whatever it starts from",
          "[unit][solver]") {
    for (const bool fixed : {true, false})
        for (const bool skip : {true, false}) {
            ContactScene scene;
            scene.gravity = 0;
            add_sheets(scene, 6, 0.5, 2);
            for (Vec3& v : scene.velocity) v = Vec3::Zero();
            for (Real& gap : scene.gap) gap = 0;
            for (Vec3& r : scene.impulse) r = Vec3(1e-20, 0, 3e-20);
            SolverSettings settings{.method = SolverMethod::pgs, .max_iterations = 50, .fixed_iterations = fixed};
            settings.skip_separating = skip;
            const SolvedScene solved = scene.solve(settings);
            CHECK(solved.regions.error[0] == 0);
            for (const Vec3& r : solved.impulse) CHECK(r == Vec3::Zero());
        }
}

TEST_CASE("a region whose contacts all separate is left alone", "[unit][solver]") {
    ContactScene scene;
    const Index a = scene.add_node(1, Vec3(0.1, 0, 1)), b = scene.add_node(1, Vec3(0, 0.2, 0.5));
    scene.touch_floor(a, 0.5);
    scene.touch_node(a, b, Vec3::UnitZ(), 0.5);
    scene.impulse.assign(2, Vec3(0, 0, 3));  // a warm start from a time when the bodies were pressed together
    const SolvedScene solved = scene.solve();
    CHECK(solved.velocity == scene.velocity);
    CHECK(solved.impulse == std::vector<Vec3>(2, Vec3::Zero()));
    CHECK(solved.regions.status[0] == RegionStatus::certified);
}

TEST_CASE("a region that does not converge says so and keeps its best iterate", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 10, 0.5, 3);
    SolverSettings settings;
    settings.tolerance = 1e-10;
    settings.max_iterations = 7;
    const SolvedScene solved = scene.solve(settings);
    CHECK(solved.regions.status[0] == RegionStatus::iteration_limit);
    CHECK(solved.regions.iterations[0] == 7);
    CHECK(solved.regions.error[0] > 1e-10);
    CHECK(solved.regions.error[0] < 0.5);
}

TEST_CASE("not-a-number stays in its region and is reported", "[unit][solver]") {
    ContactScene scene;
    add_sheets(scene, 5, 0.5, 1);
    const std::size_t healthy_nodes = scene.velocity.size(), healthy_contacts = scene.stencil.size();
    add_sheets(scene, 5, 0.5, 2);
    scene.touch_floor(scene.add_node(1, Vec3(0, 0, -1)), 0.5);
    const SolvedScene good = scene.solve();
    REQUIRE(good.regions.size() == 3);
    for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
        ContactScene broken = scene;
        broken.velocity[healthy_nodes + 7].x() = bad;
        broken.velocity.back().z() = -bad;
        const SolvedScene solved = broken.solve();
        CHECK(solved.regions.status[0] == RegionStatus::converged);
        CHECK(solved.regions.status[1] == RegionStatus::not_finite);
        CHECK(solved.regions.status[2] == RegionStatus::not_finite);
        CHECK(std::equal(good.velocity.begin(), good.velocity.begin() + static_cast<std::ptrdiff_t>(healthy_nodes),
                         solved.velocity.begin()));
        CHECK(std::equal(good.impulse.begin(), good.impulse.begin() + static_cast<std::ptrdiff_t>(healthy_contacts),
                         solved.impulse.begin()));
    }
    ContactScene broken = scene;
    broken.gap[healthy_contacts] = std::numeric_limits<Real>::quiet_NaN();
    CHECK(broken.solve().regions.status[1] == RegionStatus::not_finite);
}

TEST_CASE("a contact that only a sliver of weight could move is left alone", "[unit][solver]") {
    ContactScene scene;
    const Index moving = scene.add_node(1, Vec3(0, 0, -1)), fixed = scene.add_node(0, Vec3::Zero());
    scene.touch({{fixed, moving, fixed, fixed}, {1 - 1e-9, 1e-9, 0, 0}}, Vec3::UnitZ(), 0.5);
    CHECK(scene.solve().velocity[0] == Vec3(0, 0, -1));
}

TEST_CASE("regions whose bodies are all still are solved closer, each with the bits that it has where all are",
          "[determinism][solver]") {
    const StillSheets sheets;
    SolverSettings asked;
    asked.parallel_region_contacts = 60;
    SolverSettings closer = asked, mixed = asked;
    closer.tolerance = mixed.still_tolerance = 1e-7;
    const SolvedScene loose = sheets.scene.solve(asked), close = sheets.scene.solve(closer);
    const SolvedScene solved = sheets.solve(mixed);
    REQUIRE(solved.regions.size() == StillSheets::pairs);
    int in_lanes = 0;
    for (int k = 0; k < StillSheets::pairs; ++k) {
        CAPTURE(k);
        const auto r = static_cast<std::size_t>(k);
        const SolvedScene& expected = StillSheets::still(k) ? close : loose;
        CHECK(solved.regions.error[r] == expected.regions.error[r]);
        CHECK(solved.regions.error[r] < (StillSheets::still(k) ? 1e-7 : 1e-3));
        CHECK(solved.regions.iterations[r] == expected.regions.iterations[r]);
        for (const Index row : solved.regions.contacts[r])
            CHECK(solved.impulse[static_cast<std::size_t>(row)] == expected.impulse[static_cast<std::size_t>(row)]);
        in_lanes += solved.regions.shortcut[r] == shortcut_in_lanes;
    }
    CHECK(in_lanes > 3);
    asked.still_tolerance = 1;
    CHECK(sheets.solve(asked).impulse == loose.impulse);
}

TEST_CASE("a still region that reaches the requested tolerance has converged", "[unit][solver]") {
    const StillSheets sheets;
    SolverSettings settings;
    settings.still_tolerance = 1e-15;  // cannot be reached
    const SolvedScene solved = sheets.solve(settings);
    for (std::size_t r = 0; r < solved.regions.size(); ++r) {
        CHECK(solved.regions.status[r] == RegionStatus::converged);
        CHECK(solved.regions.error[r] < 1e-3);
    }
}

}  // namespace skerry::test::solve_regions_test
