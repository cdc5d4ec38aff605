// Fibres in whole steps, against closed forms (docs/methods/elasticity.md 2.7).
#include "skerry/fibre.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "engine/world/world_state.h"
#include "skerry/relax.h"
#include "skerry/scene.h"
#include "tests/support/same_bits.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::fibres_test {

namespace {

constexpr Real k1 = 2e4, k2 = 3;  // constants of the fibres [Pa, 1]

/// Nominal stress of the fibres at a stretch, without the active part [Pa].
Real passive_stress(Real stretch) {
    const Real strain = std::max(stretch * stretch - 1, 0.0);
    return 2 * k1 * strain * std::exp(k2 * strain * strain) * stretch;
}

MaterialSettings soft(Real damping = 0) {
    return lossless({.young_modulus = 3e4, .poisson_ratio = 0.3, .damping = damping});
}

/// A muscle along z with fibres in the given direction. The area is 0.05 m x 0.04 m, the length 0.1 m.
struct Muscle {
    static constexpr Real area = 0.05 * 0.04, length = 0.1;
    Mesh mesh = mesh::box({0.05, 0.04, length}, {2, 2, 3});
    World world;
    BodyHandle body;
    FibreHandle fibres;

    explicit Muscle(const FibreSettings& with, const MaterialSettings& material = soft(),
                    const Settings& settings = accurate(Vec3::Zero()),
                    BodyDynamics dynamics = BodyDynamics::explicit_elastic, ElementKind kind = ElementKind::smoothed)
        : world(settings) {
        body = world.add_body(
            mesh, {.material = world.add_material(material), .dynamics = dynamics, .element = kind, .name = "muscle"});
        FibreSettings of_body = with;
        of_body.body = body;
        fibres = Fibres(world).add(of_body);
    }
    void deform(const Mat3& F) { test::deform(world, body, mesh, F); }
    FibreState state() { return Fibres(world).state(fibres); }
    std::vector<Index> end(Real z) const {
        std::vector<Index> nodes;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (std::abs(mesh.nodes[n].z() - z) < 1e-9) nodes.push_back(static_cast<Index>(n));
        return nodes;
    }
};

FibreSettings along_z(Real tension = 0, Real stiffness = k1) {
    return {.direction = {{0, 0, 2}}, .stiffness = stiffness, .exponent = k2, .tension = tension};
}

}  // namespace

TEST_CASE("fibres under uniaxial stretch have the stress and the energy of the closed form", "[scene][fibres]") {
    Muscle muscle(along_z());
    for (const Real stretch : {0.8, 1.0, 1.1, 1.4}) {
        INFO("stretch " << stretch);
        const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        muscle.deform(turn * Mat3(Vec3(0.9, 1.05, stretch).asDiagonal()));
        const FibreState state = muscle.state();
        REQUIRE(state.stretch.size() == muscle.mesh.tetrahedra.size());
        const Real strain = std::max(stretch * stretch - 1, 0.0);
        for (std::size_t t = 0; t < state.stretch.size(); ++t) {
            CHECK(state.stretch[t] == Approx(stretch).epsilon(1e-12));
            CHECK(state.stress[t] == Approx(passive_stress(stretch)).epsilon(1e-6).margin(1e-9));
        }
        CHECK(state.energy == Approx(k1 / (2 * k2) * std::expm1(k2 * strain * strain) * Muscle::area * Muscle::length)
                                  .epsilon(1e-9)
                                  .margin(1e-12));
    }
}

TEST_CASE("a held muscle pulls with area times stress, and fibres beside the axis couple shear", "[scene][fibres]") {
    constexpr Real tension = 500;
    for (const Real stretch : {1.0, 1.2})
        for (const Real angle : {0.0, std::numbers::pi / 4}) {
            const Vec3 a(std::sin(angle), 0, std::cos(angle));
            FibreSettings fibres = along_z(tension);
            fibres.direction = {a};
            Muscle muscle(fibres);
            const Mat3 F = Vec3(1, 1, stretch).asDiagonal();
            muscle.deform(F);
            std::vector<Index> all(muscle.mesh.nodes.size());
            std::iota(all.begin(), all.end(), Index{0});
            muscle.world.attach(muscle.body, all);
            REQUIRE(muscle.world.advance(1e-4).ok());
            // P = (tension + passive stress) (F a / |F a|) (x) a. Its traction on the end acts on the nodes of the end.
            const Vec3 y = F * a;
            const Vec3 expected = -(tension + passive_stress(y.norm())) * Muscle::area * a.z() * y.normalized();
            Vec3 force = Vec3::Zero();
            for (const Index n : muscle.end(0.05))
                force += WorldAccess::state_of(muscle.world).model.nodes.applied_force[static_cast<std::size_t>(n)];
            CHECK((force - expected).norm() < 1e-9 * expected.norm());
            CHECK((angle == 0) == (std::abs(force.x()) < 1e-9));
        }
}

TEST_CASE("a free muscle shortens until its material balances the active tension", "[scene][fibres]") {
    constexpr Real tension = 2e3;
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::implicit_elastic}) {
        Settings settings = accurate(Vec3::Zero());
        Muscle muscle(along_z(tension), {.young_modulus = 3e4, .poisson_ratio = 0.3, .damping = 60}, settings,
                      dynamics);
        REQUIRE(muscle.world.advance(1.0).ok());
        // The state is uniform: the nominal stress of the material along z is minus the active tension, and that along
        // x and y is zero.
        const FibreState state = muscle.state();
        for (const Real stretch : state.stretch) CHECK(stretch == Approx(state.stretch[0]).epsilon(1e-4));
        CHECK(state.stretch[0] < 0.96);
        Vec3 low = Vec3::Constant(1), high = Vec3::Constant(-1);
        for (const Vec3& x : muscle.world.positions(muscle.body)) {
            low = low.cwiseMin(x);
            high = high.cwiseMax(x);
        }
        const Real area_ratio = (high.x() - low.x()) * (high.y() - low.y()) / Muscle::area;
        for (const Mat3& cauchy : muscle.world.stress(muscle.body)) {
            CHECK(cauchy(2, 2) * area_ratio == Approx(-tension).epsilon(1e-3));
            CHECK(std::abs(cauchy(0, 0)) < 1e-3 * tension);
        }
    }
}

TEST_CASE("free fibres exert no total force, no moment, and none when a body turns", "[scene][fibres]") {
    Settings settings = accurate(Vec3::Zero());
    Muscle muscle(
        {.direction = {{1, 2, 3}}, .stiffness = k1, .exponent = k2, .tension = TimeTable({{0, 0}, {0.05, 2e3}})},
        soft(), settings);
    REQUIRE(muscle.world.advance(0.05).ok());
    const WorldReport report = muscle.world.report();
    const Real size = std::sqrt(2 * muscle.world.mass(muscle.body) * report.energy.kinetic);
    CHECK(report.energy.kinetic > 0);
    CHECK(report.momentum.norm() < 1e-12 * size);
    CHECK(report.angular_momentum.norm() < 1e-11 * size * Muscle::length);
    Muscle turned(along_z());
    turned.deform(Eigen::AngleAxis<Real>(1.9, Vec3(1, 2, 3).normalized()).toRotationMatrix());
    for (const Real stress : turned.state().stress) CHECK(stress < 1e-9 * k1);
    CHECK(turned.state().energy < 1e-20);
}

TEST_CASE("forces of fibres are the derivatives of their energy", "[scene][fibres]") {
    // A body that starts at rest gets the momentum of the force in one short step.
    Settings settings = accurate(Vec3::Zero());
    settings.step_size = 1e-7;
    Muscle muscle({.direction = {{1, 0.4, 1}}, .stiffness = k1, .exponent = k2}, soft(), settings);
    Muscle plain({.direction = {{1, 0.4, 1}}}, soft(), settings);
    const std::vector<Real> mass = node_masses(muscle.world, muscle.body, muscle.mesh, 1000);
    std::vector<Vec3> shape;
    for (std::size_t n = 0; n < muscle.mesh.nodes.size(); ++n) {
        const Vec3& x = muscle.mesh.nodes[n];
        shape.emplace_back(1.2 * x.x() + x.z() * x.z(), 0.95 * x.y() + 0.3 * x.x() * x.z(), 1.15 * x.z());
    }
    const auto energy_at = [&](const std::vector<Vec3>& at) {
        muscle.world.set_positions(muscle.body, at);
        return muscle.state().energy;
    };
    for (const std::size_t n : {std::size_t{0}, std::size_t{13}, std::size_t{30}})
        for (Index axis = 0; axis < 3; ++axis) {
            constexpr Real step = 1e-6;
            std::vector<Vec3> up = shape, down = shape;
            up[n][axis] += step;
            down[n][axis] -= step;
            const Real slope = (energy_at(up) - energy_at(down)) / (2 * step);
            for (Muscle* tested : {&muscle, &plain}) {
                tested->world.set_positions(tested->body, shape);
                const std::vector<Vec3> rest(shape.size(), Vec3::Zero());
                tested->world.set_velocities(tested->body, rest);
                REQUIRE(tested->world.advance(1e-7).ok());
            }
            const Real gained =
                mass[n] * (muscle.world.velocities(muscle.body)[n] - plain.world.velocities(plain.body)[n])[axis];
            CHECK(gained / 1e-7 == Approx(-slope).epsilon(1e-5).margin(1e-6));
        }
}

TEST_CASE("the balance of energy accounts for cycles of activation, with both integrators", "[scene][fibres]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings = accurate(Vec3::Zero());
        settings.integrator = integrator;
        settings.step_size = 1e-4;
        std::vector<TimeKey> cycles;
        for (int k = 0; k < 20; ++k) cycles.push_back({0.02 * k, k % 2 == 0 ? 0.0 : 4e3});
        FibreSettings fibres = along_z();
        fibres.tension = TimeTable(cycles);
        Muscle muscle(fibres, soft(2), settings);
        muscle.deform(Vec3(0.95, 0.95, 1.15).asDiagonal());  // the passive stress acts in the first cycles
        REQUIRE(muscle.world.advance(0.4).ok());
        const WorldReport report = muscle.world.report();
        CHECK(report.energy_error_share < 1e-3);  // error of the scheme, in proportion to the step or its square
        CHECK(report.momentum_error_share < 1e-12);
    }
}

TEST_CASE("stretched stiff fibres keep their energy at the stable step, which includes their stiffness",
          "[scene][fibres]") {
    const Real without = Muscle(along_z(0, 0)).world.stable_step();
    const Real at_rest = Muscle(along_z(0, 50 * k1)).world.stable_step();
    CHECK(at_rest < without);
    // The energy of symplectic Euler oscillates in proportion to the step, but does not grow.
    for (const Real share : {1.0, 0.05}) {
        Settings settings = accurate(Vec3::Zero());
        if (share < 1) settings.step_size = share * at_rest;
        Muscle muscle(along_z(0, 50 * k1), soft(), settings);
        muscle.deform(Vec3(0.95, 0.95, 1.25).asDiagonal());
        CHECK(muscle.world.stable_step() < at_rest);
        const Real start = energy_of(muscle.world), tolerance = share < 1 ? 0.05 : 0.3;
        for (int k = 0; k < 20; ++k) {
            REQUIRE(muscle.world.advance(2e-3).ok());
            CHECK(energy_of(muscle.world) == Approx(start).epsilon(tolerance));
        }
        CHECK(muscle.world.report().energy_error_share < tolerance);
    }
    // The wave along the fibres bounds the step: with fibres much stiffer than the material, it falls with the root of
    // their modulus.
    const Real stiff = Muscle(along_z(0, 1e4 * k1)).world.stable_step();
    CHECK(Muscle(along_z(0, 4e4 * k1)).world.stable_step() == Approx(stiff / 2).epsilon(0.01));
}

TEST_CASE("a muscle that lifts a weight does the work tension times area times shortening", "[scene][fibres]") {
    // The muscle hangs from its upper end and lifts its own weight. Its tension rises slowly.
    constexpr Real tension = 3e3;
    Settings settings = accurate({0, 0, -1});
    FibreSettings fibres = along_z();
    fibres.tension = TimeTable({{0, 0}, {1, tension}});
    Muscle muscle(fibres, {.young_modulus = 3e4, .poisson_ratio = 0.3, .density = 300, .damping = 40}, settings);
    muscle.world.attach(muscle.body, muscle.end(0.05));
    Real work = 0, before_stretch = 1, before_tension = 0;
    const Real volume = Muscle::area * Muscle::length;
    const auto whole_energy = [&] {
        const Energy energy = muscle.world.report().energy;
        return energy.kinetic + energy.elastic + energy.potential + energy.dissipated;
    };
    const Real start = whole_energy();
    for (int k = 0; k < 60; ++k) {
        REQUIRE(muscle.world.advance(0.02).ok());
        const FibreState state = muscle.state();
        Real mean = 0;
        for (std::size_t t = 0; t < state.stretch.size(); ++t)
            mean += state.stretch[t] / static_cast<Real>(state.stretch.size());
        work -= (state.tension + before_tension) / 2 * (mean - before_stretch) * volume;
        before_stretch = mean;
        before_tension = state.tension;
    }
    CHECK(before_stretch < 0.95);
    // All tetrahedra of the mesh have the same volume. The attachment does no work.
    CHECK(whole_energy() - start == Approx(work).epsilon(5e-3));
}

TEST_CASE("fibres continue with the same bits with more threads, as a clone and from a file", "[scene][fibres]") {
    const auto simulate = [](int threads) {
        Settings settings = accurate({0, 0, -standard_gravity});
        settings.threads = threads;
        FibreSettings fibres = along_z();
        fibres.tension = TimeTable({{0, 0}, {0.05, 3e3}, {0.1, 0}});
        Muscle muscle(fibres, soft(5), settings);
        muscle.world.add_collider(Plane{.point = {0, 0, -0.06}});
        REQUIRE(muscle.world.advance(0.02).ok());
        return muscle;
    };
    check_same_bits(simulate, [](World& world) { REQUIRE(world.advance(0.05).ok()); });
    CHECK(simulate(3).world.state_hash() == simulate(1).world.state_hash());
}

TEST_CASE("activation wakes a muscle, and a muscle under constant tension sleeps", "[scene][fibres][sleep]") {
    Settings settings;
    settings.sleep_time = 0.1;
    Muscle muscle(along_z(500), {.young_modulus = 3e4, .damping = 100}, settings);
    muscle.world.add_collider(Plane{.point = {0, 0, -0.0505}});
    REQUIRE(muscle.world.advance(1.5).ok());
    REQUIRE(muscle.world.asleep(muscle.body));
    Fibres fibres(muscle.world);
    fibres.set_tension(muscle.fibres, 500);
    CHECK(muscle.world.asleep(muscle.body));
    fibres.set_tension(muscle.fibres, 1500);
    CHECK_FALSE(muscle.world.asleep(muscle.body));
    fibres.remove(muscle.fibres);
    CHECK_FALSE(fibres.alive(muscle.fibres));
    muscle.fibres = fibres.add({.body = muscle.body});
    muscle.world.remove(muscle.body);
    CHECK(fibres.all().empty());
}

TEST_CASE("fibres that cannot be are refused by field, and change nothing", "[scene][fibres]") {
    using Catch::Matchers::Contains;
    Muscle muscle(along_z());
    World& world = muscle.world;
    const BodyHandle ball = world.add_body(Sphere{.radius = 0.1}, {.material = world.material(muscle.body),
                                                                   .position = {3, 0, 0},
                                                                   .dynamics = BodyDynamics::rigid,
                                                                   .name = "ball"});
    Fibres fibres(world);
    const auto refused = [&](FibreSettings settings, const char* text) {
        if (settings.body == BodyHandle{}) settings.body = muscle.body;
        CHECK_THROWS_WITH(fibres.add(settings), Contains(text));
        CHECK(fibres.all().size() == 1);
    };
    refused({.body = ball}, "fibres in body 'ball': body: found a body that does not deform");
    refused({.stiffness = -1}, "stiffness: found -1, expected a modulus >= 0 (Pa)");
    refused({.exponent = -2}, "exponent");
    refused({.tension = -3}, "tension: found -3, expected a tension >= 0 (Pa)");
    refused({.direction = {Vec3::Zero()}}, "a vector that is not zero");
    refused({.direction = {Vec3::UnitX(), Vec3::UnitY()}}, "2 directions");
    refused({.tetrahedra = {0, 0}}, "tetrahedra: found tetrahedron 0");
    refused({.tetrahedra = {100000}}, "tetrahedron 100000");
    CHECK_THROWS_WITH(fibres.set_tension(muscle.fibres, -1), Contains("tension"));
}

TEST_CASE("load steps relax a muscle to the stretch of its whole tension", "[scene][fibres]") {
    const auto stretch_after = [](int load_steps) {
        Muscle muscle(along_z(2e3), soft(60));
        std::vector<Real> loads;
        const RelaxReport report =
            relax(muscle.world, {.tolerance = 1e-4, .load_steps = load_steps}, [&](const RelaxReport& now) {
                if (loads.empty() || loads.back() != now.load) loads.push_back(now.load);
                return true;
            });
        CHECK(report.converged);
        CHECK(report.load == 1);
        CHECK(loads.size() == static_cast<std::size_t>(load_steps));
        const FibreState state = muscle.state();
        CHECK(state.tension == 2e3);
        CHECK(state.stretch[0] < 0.96);
        return state.stretch[0];
    };
    CHECK(stretch_after(3) == Approx(stretch_after(1)).epsilon(1e-4));
}

TEST_CASE("a scene gives fibres by set, and directions by an array of the mesh file", "[scene][fibres]") {
    using Catch::Matchers::Contains;
    const TemporaryFolder folder;
    const std::string cells =
        "DATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 2 10\n4 0 1 "
        "2 3\n4 1 2 3 4\nCELL_TYPES 2\n10 10\nCELL_DATA 2\nVECTORS grain double\n0 0 2\n1 0 0\n";
    folder.write("mesh.vtk", "# vtk DataFile Version 3.0\nx\nASCII\n" + cells);
    const auto scene = [&](const std::string& keys) {
        return folder.write("scene.json", R"({"settings": {"gravity": [0, 0, 0]}, "materials": {"m": {}}, "bodies": [
            {"name": "leg", "mesh": {"file": "mesh.vtk"}, "material": "m", "dynamics": "explicit",
             "sets": {"far": {"half_space": {"point": [0.3, 0.3, 0.3], "normal": [1, 1, 1]}}}}],
            "fibres": [{"body": "leg", )" + keys +
                                              "}]}");
    };
    Scene loaded = load_scene(
        scene(R"("direction_array": "grain", "stiffness": 100, "exponent": 2, "tension": [[0, 0], [1, 50]])"));
    Fibres fibres(loaded.world);
    REQUIRE(fibres.all().size() == 1);
    std::vector<Vec3> shape;
    for (const Vec3& x : loaded.world.positions(loaded.world.bodies()[0]))
        shape.emplace_back(1.5 * x.x(), x.y(), 2 * x.z());
    loaded.world.set_positions(loaded.world.bodies()[0], shape);
    const FibreState state = fibres.state(fibres.all()[0]);
    REQUIRE(state.stretch.size() == 2);
    CHECK(state.stretch[0] == Approx(2));
    CHECK(state.stretch[1] == Approx(1.5));
    CHECK_THROWS_WITH(load_scene(scene(R"("tension": 1, "direction_array": "grian")")),
                      Contains("did you mean \"grain\""));
    CHECK_THROWS_WITH(load_scene(scene(R"("tension": 1)")), Contains("direction_array"));
    CHECK_THROWS_WITH(load_scene(scene(R"("tension": 1, "direction": [0, 0, 0])")),
                      Contains("fibres") && Contains("not zero"));
    CHECK_THROWS_WITH(load_scene(scene(R"("tension": 1, "direction": [0, 0, 1], "set": "nowhere")")),
                      Contains("nowhere"));
}

}  // namespace skerry::test::fibres_test
