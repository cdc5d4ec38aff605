// Stress suite: bodies that are inverted, collapsed or crushed, and surfaces with triangles of zero area (items 5, 6,
// 11 and 25 of docs/stress.md).
#include <catch2/catch.hpp>
#include <random>

#include "tests/support/jittered_box.h"
#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::shapes_test {

using namespace skerry::test::stress;

namespace {

/// A free box that is deformed as asked and then released.
struct LetGo {
    World world;
    BodyHandle body;
    Real energy = 0;    // elastic energy at release [J]
    Real inverted = 0;  // share of inverted tetrahedra at release

    template <class Place>
    LetGo(MaterialModel model, Place place)
        : world([] {
              Settings settings;
              settings.gravity = Vec3::Zero();
              return settings;
          }()) {
        const auto material =
            world.add_material({.young_modulus = 1e4, .poisson_ratio = 0.4, .damping = 20, .model = model});
        const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {4, 4, 4});
        body = world.add_body(mesh, {.material = material, .name = "box"});
        std::vector<Vec3> places;
        for (const Vec3& x : mesh.nodes) places.push_back(place(x));
        deform(world, body, places, 0.1);
        energy = world.energy().elastic;
        inverted = inverted_share(world, body);
    }

    /// Releases the box. If it need not recover, it must only stay finite, and the table records the outcome.
    void judge_recovery(int item, const std::string& scene, bool must_recover) {
        const Course course = follow(world, 2, 40);
        judge({item, scene, "every step taken, finite", course.ok ? "all steps" : course.message,
               course.ok && course.finite});
        at_most(item, scene, "energy gained / in play", course.gained / energy, 1e-2);
        const Real remaining_energy = world.energy().elastic / energy;
        const bool recovered = remaining_energy < 1e-3 && inverted_share(world, body) == 0;
        judge({item, scene + ", 2 s later",
               must_recover ? "recovers: no element inverted, energy gone" : "recovers or stays finite",
               recovered ? "recovers" : "stays collapsed with " + text(100 * remaining_energy) + " % of the energy",
               recovered || !must_recover});
    }
};

}  // namespace

TEST_CASE("a box with a fifth of its elements inside out recovers", "[scene][stress]") {
    for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        std::mt19937_64 random(5);
        LetGo box(model, [&](const Vec3& x) { return Vec3(x + 0.018 * random_vector(random)); });
        const std::string scene = "box of 384, nodes thrown about, " + std::string(name_of(model));
        at_least(5, scene, "inverted tetrahedra at the start", box.inverted, 0.2);
        box.judge_recovery(5, scene, true);
    }
}

TEST_CASE("a box collapsed to a point, a line or a plane recovers or stays finite", "[scene][stress]") {
    struct Case {
        const char* name;
        Vec3 scale;
    };
    for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean})
        for (const Case& c : {Case{"a point", {0, 0, 0}}, Case{"a line", {0, 0, 1}}, Case{"a plane", {1, 1, 0}}}) {
            LetGo box(model, [&](const Vec3& x) { return Vec3(c.scale.cwiseProduct(x)); });
            // A smooth law without a preferred direction has no force at F = 0, and none across an exact line: the
            // direction of opening is undetermined. This is not a minimum, and the next test starts close to it. The
            // corotational law has a force there. If it starts from a point, however, rounding decides which elements
            // end up twisted against each other (they do for two of nine step lengths).
            const bool must_recover = c.scale.sum() == 2 || (model == MaterialModel::corotational && c.scale.sum() > 0);
            box.judge_recovery(6, "box of 384 collapsed to " + std::string(c.name) + ", " + std::string(name_of(model)),
                               must_recover);
        }
}

TEST_CASE("a box pressed together to hundredths of its size recovers", "[scene][stress]") {
    struct Case {
        const char* name;
        Vec3 scale;
        Real noise;  // m
        bool must_recover;
    };
    // The short form of the stable neo-Hookean law (no logarithm) contracts below a fifth at this Poisson's ratio.
    for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean})
        // The last two cases open in different directions in different places: tetrahedra end up not inverted, but
        // wound about an edge or twisted.
        for (const Case& c :
             {Case{"to a tenth on all sides", {0.1, 0.1, 0.1}, 0, true},
              Case{"to a hundredth on all sides", {0.01, 0.01, 0.01}, 0, true},
              Case{"into a heap of nodes, a hundredth of its size about a point", {0, 0, 0}, 1e-3, false},
              Case{"to a line, but for 1e-9 of its size", {0, 0, 1}, 1e-10, false}}) {
            std::mt19937_64 random(6);
            LetGo box(model,
                      [&](const Vec3& x) { return Vec3(c.scale.cwiseProduct(x) + c.noise * random_vector(random)); });
            box.judge_recovery(6, "box of 384 pressed " + std::string(c.name) + ", " + std::string(name_of(model)),
                               c.must_recover);
        }
}

TEST_CASE("triangles without area and edges without length do no harm to a collider", "[scene][stress]") {
    const auto drop = [](bool degenerate) {
        World world;
        const auto material = world.add_material({.young_modulus = 5e4, .friction = 0.4, .damping = 100});
        SurfaceMesh slab = mesh::boundary(mesh::box({0.5, 0.5, 0.1}, {2, 2, 1}));
        if (degenerate) {
            const auto first = slab.triangles.front();
            const Vec3 a = slab.nodes[static_cast<std::size_t>(first[0])];
            const auto count = static_cast<Index>(slab.nodes.size());
            slab.nodes.push_back(a);                                      // on a corner
            slab.nodes.push_back({0.01, 0.02, 0.05});                     // inside the top, where the ball comes down
            slab.nodes.push_back({0.01, 0.02, 0.05});                     // at the same place
            slab.nodes.push_back({0.02, 0.04, 0.05});                     // collinear with it
            slab.triangles.push_back({first[0], count, first[1]});        // an edge without length
            slab.triangles.push_back({count + 1, count + 2, count + 3});  // again an edge without length
            slab.nodes.push_back({0.03, 0.06, 0.05});
            slab.triangles.push_back({count + 1, count + 3, count + 4});  // three collinear points
        }
        world.add_collider(slab, {.position = {0, 0, -0.05}});
        world.add_body(mesh::ball(0.05, 6), {.material = material, .position = {0.01, 0.02, 0.06}});
        return world;
    };
    World with = drop(true), without = drop(false);
    const Course course = follow(with, 0.5, 50);
    follow(without, 0.5, 50);
    const std::string scene = "ball on a slab with three triangles of no area, 0.5 s";
    judge(
        {11, scene, "every step taken, finite", course.ok ? "all steps" : course.message, course.ok && course.finite});
    at_most(11, scene, "penetration / edge", course.max_penetration / with.mean_edge(with.bodies()[0]), 1e-2);
    at_most(11, scene, "distance from where it rests without them, m",
            (with.center_of_mass(with.bodies()[0]) - without.center_of_mass(without.bodies()[0])).norm(), 1e-4);
}

TEST_CASE("a plate crushes a box to a tenth of its height", "[scene][stress]") {
    for (const MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        World world, undisturbed;
        const Real height = 0.1, shell = 1e-3;
        for (World* w : {&world, &undisturbed}) {
            const auto material = w->add_material(
                {.young_modulus = 1e4, .poisson_ratio = 0.3, .friction = 0.4, .damping = 20, .model = model});
            w->add_collider(Plane{});
            // Without self-contact the sides fold through each other, and a symmetric box stays as it is then.
            w->add_body(
                mesh::box({0.1, 0.1, height}, {4, 4, 4}),
                {.material = material, .position = {0, 0, 0.0505}, .contact_distance = shell, .self_contact = true});
        }
        const auto body = world.bodies()[0];
        ColliderSettings plate;
        const Real thickness = 0.02, start = height + shell + thickness / 2 + 1e-4,
                   end = 0.1 * height + shell + thickness / 2;
        plate.motion.keys = {{0, {0, 0, start}, Vec3::Zero()},
                             {0.5, {0, 0, end}, Vec3::Zero()},
                             {0.7, {0, 0, end}, Vec3::Zero()},
                             {1, {0, 0, 2 * start}, Vec3::Zero()}};
        world.add_collider(Box{{0.4, 0.4, thickness}}, plate);
        const Course crushing = follow(world, 0.7, 70);
        const std::string scene = "box of 384 pressed to a tenth of its height, " + std::string(name_of(model));
        judge({25, scene, "every step taken, finite", crushing.ok ? "all steps" : crushing.message,
               crushing.ok && crushing.finite});
        Real top = 0, bottom = 1;
        for (const auto& triangle : world.surface(body))  // inner nodes have no contact with the floor
            for (const Index n : triangle) {
                const Real z = world.positions(body)[static_cast<std::size_t>(n)].z();
                top = std::max(top, z);
                bottom = std::min(bottom, z);
            }
        at_most(25, scene, "height / height at rest", (top - bottom) / height, 0.105);
        at_most(25, scene, "penetration / edge", crushing.max_penetration / (height / 4), 2e-2);
        const Course after = follow(world, 3.3, 165);
        judge({25, scene + ", then let go", "every step taken, finite", after.ok ? "all steps" : after.message,
               after.ok && after.finite});
        follow(undisturbed, 1, 10);
        // The ratio is 0.93 under the body's weight; friction keeps its foot a little wider than before.
        const Real volume_ratio = world.report().worst_volume_ratio;
        const bool recovered =
            inverted_share(world, body) == 0 && std::abs(volume_ratio - undisturbed.report().worst_volume_ratio) < 0.05;
        judge({25, scene + ", 3 s after it was let go", "recovers", recovered ? "recovers" : "stays collapsed",
               recovered && after.finite});
    }
}

}  // namespace skerry::test::shapes_test
