// Materials that yield: stresses in closed form, energy, stability, saving, changes and refusals.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <sstream>

#include "skerry/error.h"
#include "tests/support/element_kinds.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::scene_plasticity_test {

namespace {

constexpr Real young = 1e6, poisson = 0.3, yield = 1e3, hardening = 5e3;  // Pa

MaterialSettings metal() {
    return lossless({.young_modulus = young,
                     .poisson_ratio = poisson,
                     .density = 1000,
                     .model = MaterialModel::hencky,
                     .plasticity = Plasticity{yield, hardening}});
}

struct Block {
    Mesh mesh;
    World world;
    BodyHandle body;

    explicit Block(const MaterialSettings& material, ElementKind kind = ElementKind::smoothed,
                   const Settings& settings = {.gravity = Vec3::Zero()}, const Vec3& rotation = Vec3::Zero(),
                   const Vec3& size = {0.1, 0.1, 0.1}, const std::array<int, 3>& cells = {2, 2, 2})
        : mesh(mesh::box(size, cells)), world(settings) {
        body = world.add_body(mesh, {.material = world.add_material(material), .rotation = rotation, .element = kind});
    }
    void deform(const Mat3& F) { test::deform(world, body, mesh, F); }
    /// Kirchhoff stress of the first tetrahedron in the shape F [Pa].
    Mat3 kirchhoff(const Mat3& F) {
        deform(F);
        return world.stress(body)[0] * F.determinant();
    }
    Real plastic_strain() const { return world.plastic_strain(body)[0]; }
};

Mat3 axial(Real along, Real across) {
    return Vec3(std::exp(along), std::exp(across), std::exp(across)).asDiagonal();
}

}  // namespace

TEST_CASE("a bar in tension yields, unloads elastically, and yields again at the hardened stress", "[scene]") {
    // Logarithmic strains: e = s/E + p along the bar and -nu s/E - p/2 across it, with the stress s and the plastic
    // strain p. After the first yield s = yield + hardening p.
    const auto shape = [](Real s, Real p) { return axial(s / young + p, -poisson * s / young - p / 2); };
    for (const ElementKind kind : {ElementKind::smoothed, ElementKind::linear, ElementKind::edge_smoothed}) {
        Block bar(metal(), kind);
        const auto check = [&](Real s, Real p) {
            const Mat3 stress = bar.kirchhoff(shape(s, p));
            INFO(name_of(kind) << ": stress " << s << ", plastic strain " << p);
            // The law has the pressure K (J - 1) in place of K log J, a relative difference below the elastic strain.
            const Real tolerance = 1e-3 * std::max(yield, std::abs(s));
            CHECK(std::abs(stress(0, 0) - s) < tolerance);
            CHECK(std::abs(stress(1, 1)) < tolerance);
            CHECK(std::abs(bar.plastic_strain() - p) < 1e-6);
        };
        check(0.9 * yield, 0);
        check(yield + hardening * 0.01, 0.01);
        check(yield + hardening * 0.5, 0.5);
        check(0, 0.5);  // residual strain
        check(-0.9 * (yield + hardening * 0.5), 0.5);
        check(0.999 * (yield + hardening * 0.5), 0.5);
        check(yield + hardening * 0.6, 0.6);
    }
}

TEST_CASE("pure shear yields at the yield stress over the square root of 3, and pressure never", "[scene]") {
    MaterialSettings perfect = metal();
    perfect.plasticity->hardening = 0;
    Block block(perfect);
    const Mat3 stress = block.kirchhoff(Vec3(std::exp(0.2), std::exp(-0.2), 1).asDiagonal());
    CHECK((stress(0, 0) - stress(1, 1)) / 2 == Approx(yield / std::sqrt(3.0)).epsilon(1e-9));
    CHECK(block.plastic_strain() == Approx(2 / std::sqrt(3.0) * 0.2).epsilon(0.01));
    Block pressed(perfect);
    const Mat3 pressure = pressed.kirchhoff(0.8 * Mat3::Identity());
    CHECK(pressure(0, 0) < -100 * yield);
    CHECK(pressed.plastic_strain() == 0);
}

TEST_CASE("a rotation turns the stress of a body that has flowed, and causes no flow", "[scene]") {
    Block block(metal());
    const Mat3 F = axial(0.3, -0.14), R = Eigen::AngleAxis<Real>(2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Mat3 before = block.kirchhoff(F);
    const Real flowed = block.plastic_strain();
    CHECK((block.kirchhoff(R * F) - R * before * R.transpose()).norm() < 1e-9 * before.norm());
    CHECK(block.plastic_strain() == flowed);
}

TEST_CASE("kinetic energy becomes elastic energy and plastic work, with an error that falls with the step", "[scene]") {
    std::vector<Real> error;
    for (const Real share : {0.1, 0.05}) {
        Settings settings{.gravity = Vec3::Zero()};
        settings.step_size = share * 0.9 * Block(metal()).world.stable_step();
        Block block(metal(), ElementKind::smoothed, settings);
        std::vector<Vec3> velocity;
        for (const Vec3& x : block.mesh.nodes) velocity.emplace_back(60 * x.x(), -20 * x.y(), -10 * x.z());
        block.world.set_velocities(block.body, velocity);
        const Real start = energy_of(block.world);
        Real dissipated = 0;
        for (int k = 0; k < 50; ++k) {
            REQUIRE(block.world.advance(4e-4).ok());
            const WorldReport report = block.world.report();
            CHECK(report.plastic_work >= dissipated);
            CHECK(report.energy.dissipated == report.plastic_work);
            dissipated = report.plastic_work;
        }
        const WorldReport report = block.world.report();
        CHECK(report.plastic_work > 0.3 * start);
        CHECK(report.energy_error < 1e-3 * start);
        CHECK(report.momentum.norm() < 1e-12);
        error.push_back(report.energy_error / start);
    }
    CHECK(error[1] < 0.7 * error[0]);
}

TEST_CASE("a bar that is drawn to three times its length stays stable and keeps its volume", "[scene]") {
    MaterialSettings soft = metal();
    soft.loss_factor = 0.05;
    soft.bulk_viscosity = 0.06;
    soft.plasticity->hardening = 3e3;
    Block bar(soft, ElementKind::smoothed, {.gravity = Vec3::Zero()}, Vec3::Zero(), {0.12, 0.04, 0.04}, {6, 2, 2});
    const auto end = [&](Real side) {
        std::vector<Index> nodes;
        for (std::size_t n = 0; n < bar.mesh.nodes.size(); ++n)
            if (std::abs(bar.mesh.nodes[n].x() - side * 0.06) < 1e-9) nodes.push_back(static_cast<Index>(n));
        return nodes;
    };
    bar.world.attach(bar.body, end(-1), Motion{.velocity = Vec3(-0.6, 0, 0)});
    bar.world.attach(bar.body, end(1), Motion{.velocity = Vec3(0.6, 0, 0)});
    const StepReport step = bar.world.advance(0.2);
    INFO(step.message());
    REQUIRE(step.ok());
    Real volume = 0;
    const auto x = bar.world.positions(bar.body);
    for (const auto& t : bar.mesh.tetrahedra) {
        const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
        volume += (at(1) - at(0)).dot((at(2) - at(0)).cross(at(3) - at(0))) / 6;
    }
    CHECK(volume == Approx(0.12 * 0.04 * 0.04).epsilon(0.02));
    CHECK(std::ranges::max(bar.world.plastic_strain(bar.body)) > 1);
    const WorldReport report = bar.world.report();
    CHECK(report.inverted == 0);
    CHECK(report.energy_error_share < 0.02);
}

TEST_CASE(
    "a ball of clay is dented by its fall, sleeps, and has the same bits on any number of workers and after loading",
    "[scene][determinism]") {
    const auto make = [](int threads) {
        Settings settings;
        settings.threads = threads;
        World world(settings);
        world.add_collider(Plane{});
        const auto clay = world.add_material({.young_modulus = 1e6,
                                              .density = 1800,
                                              .model = MaterialModel::hencky,
                                              .plasticity = Plasticity{1e4, 1e4}});
        for (int i = 0; i < 2; ++i)
            world.add_body(
                mesh::ball(0.05, 4),
                {.material = clay, .position = {0.2 * i, 0, 0.06}, .velocity = {0, 0, -5}, .collision_group = 1});
        return world;
    };
    World one = make(1), three = make(3);
    for (World* world : {&one, &three}) REQUIRE(world->advance(0.01).ok());
    CHECK(one.report().plastic_work > 0);
    const TemporaryFolder folder;
    one.save(folder.path() / "world");
    World loaded = World::load(folder.path() / "world"), copy = one.clone();
    for (World* world : {&one, &three, &loaded, &copy}) REQUIRE(world->advance(0.01).ok());
    for (const World* world : {&three, &loaded, &copy}) CHECK(world->state_hash() == one.state_hash());
    const BodyHandle ball = one.bodies()[0];
    const auto height = [&] {
        const auto x = one.positions(ball);
        const auto [low, high] = std::ranges::minmax_element(x, {}, [](const Vec3& p) { return p.z(); });
        return high->z() - low->z();
    };
    REQUIRE(one.advance(1.0).ok());
    CHECK(one.report().asleep == 2);
    CHECK(height() < 0.097);
    const std::uint64_t resting = one.state_hash();
    one.reset(ball);
    CHECK(height() == Approx(0.1).epsilon(1e-9));
    CHECK(one.state_hash() != resting);
    CHECK(std::ranges::max(one.plastic_strain(ball)) == 0);
}

TEST_CASE("a body that is reset after plastic flow deforms as a new one", "[scene]") {
    Block used(metal(), ElementKind::smoothed, {.gravity = Vec3::Zero()}, {0.4, -1, 0.3});
    Block fresh(metal(), ElementKind::smoothed, {.gravity = Vec3::Zero()}, {0.4, -1, 0.3});
    used.deform(axial(0.3, -0.14));
    used.world.reset(used.body);
    CHECK(used.world.energy().elastic < 1e-20);
    const Mat3 F = axial(-0.1, 0.2), expected = fresh.kirchhoff(F);
    CHECK((used.kirchhoff(F) - expected).norm() < 1e-8 * expected.norm());
    CHECK(used.plastic_strain() == Approx(fresh.plastic_strain()).epsilon(1e-9));
}

TEST_CASE("a trace shows the plastic flow of worlds with a material that yields", "[scene]") {
    for (const bool yields : {true, false}) {
        MaterialSettings material = metal();
        if (!yields) material.plasticity.reset();
        World world({.gravity = Vec3::Zero()});
        world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = world.add_material(material)});
        world.set_tracing(true);
        REQUIRE(world.advance(1e-4).ok());
        std::ostringstream trace;
        world.write_trace(trace);
        CHECK((trace.str().find("dynamics/yield_elements") != std::string::npos) == yields);
    }
}

TEST_CASE("plasticity is refused where it does not act, and only its values change", "[scene]") {
    using Catch::Contains;
    World world({.gravity = Vec3::Zero()});
    MaterialSettings wrong = metal();
    wrong.model = MaterialModel::stable_neo_hookean;
    CHECK_THROWS_WITH(world.add_material(wrong),
                      Contains("material: model: found stable_neo_hookean, expected hencky"));
    wrong = metal();
    wrong.plasticity->yield_stress = 0;
    CHECK_THROWS_WITH(world.add_material(wrong), Contains("plasticity.yield_stress: found 0, expected a stress > 0"));
    wrong.plasticity = Plasticity{1, -1};
    CHECK_THROWS_WITH(world.add_material(wrong), Contains("plasticity.hardening: found -1"));
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const MaterialHandle material = world.add_material(metal());
    CHECK(world.material(material).plasticity == metal().plasticity);
    CHECK_THROWS_WITH(
        world.add_body(mesh, {.material = material, .dynamics = BodyDynamics::implicit_elastic, .name = "can"}),
        Contains("body 'can': plasticity: found a material of an implicit body that yields"));
    const BodyHandle body = world.add_body(mesh, {.material = material, .name = "can"});
    CHECK(world.dynamics_choice(body).reason == DynamicsReason::plasticity);
    MaterialSettings next = metal();
    next.plasticity.reset();
    try {
        world.set_material(material, next);
        FAIL("a material lost its plasticity");
    } catch (const SceneError& error) {
        CHECK(error.complaint().found == "no plasticity");
        CHECK(error.complaint().expected == "plasticity");
        CHECK_THAT(error.complaint().hint, Contains("add a body with a new material"));
    }
    std::vector<Vec3> shape;
    for (const Vec3& x : mesh.nodes) shape.emplace_back(axial(0.3, -0.14) * x);
    world.set_positions(body, shape);
    next = metal();
    next.plasticity->hardening = 7e3;
    world.set_material(material, next);
    CHECK(world.material(material).plasticity->hardening == 7e3);
    next.young_modulus = 2e6;
    CHECK_THROWS_WITH(world.set_material(material, next), Contains("body 'can', which has deformed plastically"));
    CHECK_THROWS_WITH(world.set_dynamics(body, BodyDynamics::rigid), Contains("deformed plastically"));
    world.reset(body);
    world.set_material(material, next);
    world.set_dynamics(body, BodyDynamics::rigid);
    CHECK(world.plastic_strain(body) == std::vector<Real>(mesh.tetrahedra.size(), 0));
}

}  // namespace skerry::test::scene_plasticity_test
