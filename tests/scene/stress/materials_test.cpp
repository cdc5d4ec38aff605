// Stress suite: large ratios of mass and modulus, nearly incompressible bodies, slivers, high stacks (items 1 to 4 and
// 19 of docs/stress.md).
#include <catch2/catch.hpp>

#include "tests/support/elastic_body.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::stress_materials_test {

using namespace skerry::test::stress;

namespace {

/// Turns gravity on slowly. The vibration after a sudden load is not a subject of these tests.
Course load_slowly(World& world, Real seconds) {
    Course course;
    const Vec3 full = world.settings().gravity;
    const int turns = 100;
    for (int i = 1; i <= turns && course.ok; ++i) {
        const Real s = static_cast<Real>(i) / turns;
        world.set_gravity(full * s * s * s * (10 - 15 * s + 6 * s * s));
        const Course part = follow(world, seconds / turns, 1);
        course.ok = part.ok;
        course.message = part.message;
        course.finite &= part.finite;
        course.unconverged += part.unconverged;
        course.max_penetration = std::max(course.max_penetration, part.max_penetration);
    }
    return course;
}

Real volume_of_body(const World& world, BodyHandle body) {
    Real sum = 0;
    const auto x = world.positions(body);
    for (const auto& t : world.tetrahedra(body)) {
        const auto at = [&](std::size_t a) -> const Vec3& { return x[static_cast<std::size_t>(t[a])]; };
        sum += (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6;
    }
    return sum;
}

/// Stable step over the exact limit at rest. The limit comes from the linear law, which has the same stiffness there
/// and whose finite differences do not suffer from slivers.
Real share_of_limit(const TetMesh& mesh, MaterialModel model, Real nu) {
    ElasticBody linear(mesh, material_constants(MaterialModel::linear, 1e5, nu, 1000));
    return stable_step_of(ElasticBody(mesh, material_constants(model, 1e5, nu, 1000))) / exact_limit(linear);
}

}  // namespace

TEST_CASE("a block rests on one a millionth of its mass", "[scene][stress]") {
    World world;
    const auto light = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .density = 1});
    const auto heavy = world.add_material({.young_modulus = 1e8, .poisson_ratio = 0.3, .density = 1e6});
    world.add_collider(Plane{});
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const auto lower = world.add_body(
        mesh, {.material = light, .position = {0, 0, 0.051}, .contact_distance = 0.002, .name = "light"});
    const auto upper = world.add_body(
        mesh, {.material = heavy, .position = {0.011, 0.007, 0.153}, .contact_distance = 0.002, .name = "heavy"});
    REQUIRE(world.mass(upper) == Approx(1e6 * world.mass(lower)));
    const Course loading = load_slowly(world, 0.2), resting = follow(world, 0.1, 100);
    const std::string scene = "1 t on 1 g, 0.3 s";
    judge({1, scene, "every step taken, finite", loading.message + resting.message + "all steps",
           loading.ok && resting.ok && loading.finite && resting.finite});
    Real speed = 0;
    for (const Vec3& v : world.velocities(upper)) speed = std::max(speed, v.norm());
    // The load is applied within three periods of the mass on its spring (0.06 s). The remaining vibration is a few per
    // cent of a sag of a millimetre.
    at_most(1, scene, "speed of the heavy block at the end, m/s", speed, 0.02);
    at_most(1, scene, "penetration / edge", std::max(loading.max_penetration, resting.max_penetration) / 0.1, 1e-3);
    at_most(1, scene + ", " + text(world.report().mean_iterations) + " sweeps a region on average",
            "regions not converged", loading.unconverged + resting.unconverged, 0);
}

TEST_CASE("bodies with moduli from 1e3 to 1e9 Pa share a scene", "[scene][stress]") {
    World world;
    world.add_collider(Plane{});
    const Real edge = 0.04;
    for (int k = 3; k <= 9; ++k) {
        const auto material =
            world.add_material({.young_modulus = std::pow(10.0, k), .poisson_ratio = 0.3, .damping = 5});
        // A row on the floor, and a second row across it, so that every body rests on softer and on stiffer ones.
        for (int row = 0; row < 2; ++row)
            world.add_body(mesh::box({edge, edge, edge}, {2, 2, 2}),
                           {.material = material,
                            .position = {1.1 * edge * (row == 0 ? k : 12 - k), 0.003 * k, (0.55 + 1.1 * row) * edge},
                            .name = "E 1e" + std::to_string(k)});
    }
    const Course course = follow(world, 0.25, 50);
    const std::string scene = "14 boxes of 1e3 to 1e9 Pa, 0.25 s";
    judge({2, scene, "every step taken, finite", course.ok ? "all steps" : course.message, course.ok && course.finite});
    at_most(2, scene, "energy gained / in play", course.gain(), 1e-2);
    at_most(2, scene, "penetration / edge", course.max_penetration / edge, 1e-2);
    judge({2, scene, "the report names the body that bounds the step", world.report().stable_step_body,
           world.report().stable_step_body == "E 1e9"});
}

TEST_CASE("nearly incompressible bodies keep their volume and their step", "[scene][stress]") {
    for (const Real nu : {0.49, 0.499, 0.4999}) {
        World world;
        world.add_collider(Plane{});
        const auto material =
            world.add_material({.young_modulus = 1e4, .poisson_ratio = nu, .friction = 0.5, .damping = 5});
        const auto body =
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}), {.material = material, .position = {0, 0, 0.06}});
        const Real rest = volume_of_body(world, body);
        Course whole;
        Real worst = 0;
        for (int part = 0; part < 25; ++part) {
            const Course course = follow(world, 0.02, 1);
            whole.ok &= course.ok;
            whole.finite &= course.finite;
            whole.gained = std::max(whole.gained, course.gained);
            whole.in_play = std::max(whole.in_play, course.in_play);
            worst = std::max(worst, std::abs(volume_of_body(world, body) / rest - 1));
        }
        const std::string scene = "box dropped, nu " + text(nu) + ", 0.5 s";
        judge({3, scene, "every step taken, finite", whole.ok ? "all steps" : "refused", whole.ok && whole.finite});
        at_most(3, scene, "volume error", worst, 1e-2);
        at_most(3, scene, "energy gained / in play", whole.gain(), 1e-2);
    }
    const TetMesh mesh = jittered_box({3, 3, 3}, 0.1, 0.2, 11, 0.02);
    for (const Real nu : {0.49, 0.499, 0.4999}) {
        const Real share = share_of_limit(mesh, MaterialModel::stable_neo_hookean, nu);
        judge(
            {3, "stable step, nu " + text(nu), "0.5 to 1 of the exact limit", text(share), share <= 1 && share >= 0.5});
    }
}

TEST_CASE("a sliver shortens the step at most to half of its own stable step", "[scene][stress]") {
    TetMesh mesh = jittered_box({3, 3, 3}, 0.1, 0, 1);
    // Moves an inner node close to the middle of the opposite face: altitude over edge 1e-4.
    const Index inner = (1 * 4 + 1) * 4 + 1;
    const auto sliver = *std::find_if(mesh.tetrahedra.begin(), mesh.tetrahedra.end(),
                                      [&](const auto& t) { return std::find(t.begin(), t.end(), inner) != t.end(); });
    std::vector<Vec3> across;
    for (const Index n : sliver)
        if (n != inner) across.push_back(mesh.nodes[static_cast<std::size_t>(n)]);
    const Real area = (across[1] - across[0]).cross(across[2] - across[0]).norm() / 2;
    const Real altitude = 3 * volume_of(mesh, sliver) / area;
    const Vec3 middle = (across[0] + across[1] + across[2]) / 3;
    Vec3& moved = mesh.nodes[static_cast<std::size_t>(inner)];
    moved = middle + 1e-4 * 0.1 / altitude * (moved - middle);
    for (const auto& t : mesh.tetrahedra) REQUIRE(volume_of(mesh, t) > 0);
    for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        const Real share = share_of_limit(mesh, model, 0.3);
        judge({4, "sliver of altitude 1e-4 edges, " + std::string(name_of(model)),
               "stable step 0.5 to 1 of the exact limit", text(share), share <= 1 && share >= 0.5});
    }
}

TEST_CASE("a stack of twenty soft or stiff slabs remains standing", "[scene][stress][slow]") {
    // A column buckles under its own weight above (7.84 E I / (rho g A))^(1/3) (Greenhill). That is 1.4 m for the soft
    // one, whose height is 1 m.
    for (const Real modulus : {5e5, 5e7}) {
        World world;
        world.add_collider(Plane{});
        const auto material = world.add_material(
            {.young_modulus = modulus, .poisson_ratio = 0.3, .density = 500, .friction = 0.6, .damping = 20});
        const Real width = 0.2, height = 0.05, shell = 1e-3;
        std::vector<BodyHandle> slabs;
        for (int k = 0; k < 20; ++k)
            slabs.push_back(world.add_body(mesh::box({width, width, height}, {2, 2, 1}),
                                           {.material = material,
                                            .position = {0, 0, shell / 2 + height / 2 + k * (height + shell)},
                                            .contact_distance = shell}));
        const Course loading = load_slowly(world, 0.5), resting = follow(world, 0.5, 50);
        const std::string scene = "20 slabs, " + text(modulus) + " Pa, 1 s";
        judge({19, scene, "every step taken, finite", loading.message + resting.message + "all steps",
               loading.ok && resting.ok && loading.finite && resting.finite});
        Real aside = 0;
        bool ordered = true;
        for (std::size_t k = 0; k < slabs.size(); ++k) {
            const Vec3 x = world.center_of_mass(slabs[k]);
            aside = std::max(aside, x.head<2>().norm());
            if (k > 0) ordered &= x.z() > world.center_of_mass(slabs[k - 1]).z() + height / 2;
        }
        at_most(19, scene, "way aside / width", aside / width, 0.05);
        judge({19, scene, "in order from bottom to top", ordered ? "yes" : "no", ordered});
        at_most(19, scene, "penetration / height", std::max(loading.max_penetration, resting.max_penetration) / height,
                1e-2);
        at_most(19, scene, "energy gained at rest / in play", resting.gain(), 1e-2);
    }
}

}  // namespace skerry::test::stress_materials_test
