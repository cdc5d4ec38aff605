// Stress suite: NaN, infinite and out-of-range input at every public call (item 18 of docs/stress.md).
#include <catch2/catch.hpp>
#include <functional>
#include <limits>

#include "engine/world/tuning.h"
#include "skerry/problem.h"
#include "skerry/scene.h"
#include "tests/support/stress.h"
#include "tests/support/worlds.h"

namespace skerry::test::inputs_test {

using namespace skerry::test::stress;

namespace {

constexpr Real no_number = std::numeric_limits<Real>::quiet_NaN(), inf = std::numeric_limits<Real>::infinity();

/// A call that must be refused with a message that names `object` and `field`.
struct Refusal {
    std::string object, field;
    std::function<void()> call;
};

/// Describes the fault of the refusal, or returns an empty string.
std::string wrong_with(const Refusal& refusal) {
    const std::string object_and_field = refusal.object + "." + refusal.field;
    try {
        refusal.call();
    } catch (const SceneError& error) {
        const std::string message = error.what();
        for (const std::string& part : {refusal.object, refusal.field})
            if (message.find(part) == std::string::npos)
                return object_and_field + ": '" + message + "' does not name " + part + "; ";
        return {};
    } catch (const std::exception& error) {
        return object_and_field + ": another exception: " + error.what() + "; ";
    }
    return object_and_field + ": taken; ";
}

void judge_refusals(const std::string& item, const std::vector<Refusal>& refusals) {
    std::string wrong;
    for (const Refusal& refusal : refusals) wrong += wrong_with(refusal);
    judge({18, item + ": " + std::to_string(refusals.size()) + " bad values", "all refused, object and field named",
           wrong.empty() ? "all" : wrong, wrong.empty()});
}

/// Appends a refusal for each way in which a member that must be finite can be wrong.
template <class Record, class Make>
void add_bad(std::vector<Refusal>& list, const std::string& object, const std::string& field, const Record& good,
             Make make, const std::vector<std::function<void(Record&)>>& spoil) {
    for (const auto& change : spoil) {
        Record bad = good;
        change(bad);
        list.push_back({object, field, [bad, make] { make(bad); }});
    }
}

}  // namespace

TEST_CASE("settings and materials that are no numbers or out of range are refused by name", "[scene][stress]") {
    std::vector<Refusal> list;
    const auto settings = [&list](const char* field, const std::vector<std::function<void(Settings&)>>& spoil) {
        add_bad<Settings>(
            list, "settings", field, {}, [](const Settings& bad) { World world(bad); }, spoil);
    };
    const auto tuning = [&list](const char* field, const std::vector<std::function<void(Tuning&)>>& spoil) {
        add_bad<Tuning>(
            list, "tuning", field, {}, [](const Tuning& bad) { tuned_world({}, bad); }, spoil);
    };
    for (const Real bad : {no_number, inf, -inf}) {
        settings("gravity", {[bad](Settings& s) { s.gravity.y() = bad; }});
        settings("step_size", {[bad](Settings& s) { s.step_size = bad; }});
        tuning("step_safety", {[bad](Tuning& t) { t.step_safety = bad; }});
        settings("tolerance", {[bad](Settings& s) { s.tolerance = bad; }});
        tuning("relaxation", {[bad](Tuning& t) { t.relaxation = bad; }});
        tuning("max_strain_step", {[bad](Tuning& t) { t.max_strain_step = bad; }});
        tuning("restitution_speed", {[bad](Tuning& t) { t.restitution_speed = bad; }});
        settings("recovery_speed", {[bad](Settings& s) { s.recovery_speed = bad; }});
        tuning("sleep_speed", {[bad](Tuning& t) { t.sleep_speed = bad; }});
        settings("sleep_time", {[bad](Settings& s) { s.sleep_time = bad; }});
    }
    settings("step_size", {[](Settings& s) { s.step_size = 0; }, [](Settings& s) { s.step_size = -1e-3; }});
    tuning("step_safety", {[](Tuning& t) { t.step_safety = 0; }, [](Tuning& t) { t.step_safety = 1.1; }});
    settings("tolerance", {[](Settings& s) { s.tolerance = 0; }, [](Settings& s) { s.tolerance = 1; }});
    tuning("relaxation", {[](Tuning& t) { t.relaxation = 0; }, [](Tuning& t) { t.relaxation = 2; }});
    settings("max_iterations", {[](Settings& s) { s.max_iterations = 0; }, [](Settings& s) { s.max_iterations = -5; }});
    settings("threads", {[](Settings& s) { s.threads = -1; }});
    judge_refusals("settings", list);

    list.clear();
    const auto material = [&list](const char* field, const std::vector<std::function<void(MaterialSettings&)>>& spoil) {
        add_bad<MaterialSettings>(
            list, "material", field, {}, [](const MaterialSettings& bad) { World().add_material(bad); }, spoil);
    };
    for (const Real bad : {no_number, inf, -inf}) {
        material("young_modulus", {[bad](MaterialSettings& m) { m.young_modulus = bad; }});
        material("poisson_ratio", {[bad](MaterialSettings& m) { m.poisson_ratio = bad; }});
        material("density", {[bad](MaterialSettings& m) { m.density = bad; }});
        material("friction", {[bad](MaterialSettings& m) { m.friction = bad; }});
        material("static_friction", {[bad](MaterialSettings& m) { m.static_friction = bad; }});
        material("dynamic_friction", {[bad](MaterialSettings& m) { m.dynamic_friction = bad; }});
        material("restitution", {[bad](MaterialSettings& m) { m.restitution = bad; }});
        material("damping", {[bad](MaterialSettings& m) { m.damping = bad; }});
        material("loss_factor", {[bad](MaterialSettings& m) { m.loss_factor = bad; }});
        material("bulk_viscosity", {[bad](MaterialSettings& m) { m.bulk_viscosity = bad; }});
    }
    material("young_modulus",
             {[](MaterialSettings& m) { m.young_modulus = 0; }, [](MaterialSettings& m) { m.young_modulus = -1; }});
    material("poisson_ratio",
             {[](MaterialSettings& m) { m.poisson_ratio = 0.5; }, [](MaterialSettings& m) { m.poisson_ratio = -1; }});
    material("density", {[](MaterialSettings& m) { m.density = 0; }, [](MaterialSettings& m) { m.density = -1; }});
    material("friction", {[](MaterialSettings& m) { m.friction = -0.1; }});
    material("static_friction", {[](MaterialSettings& m) { m.static_friction = 0.1; }});
    material("restitution",
             {[](MaterialSettings& m) { m.restitution = 1.1; }, [](MaterialSettings& m) { m.restitution = -0.1; }});
    material("damping", {[](MaterialSettings& m) { m.damping = -1; }});
    material("loss_factor",
             {[](MaterialSettings& m) { m.loss_factor = -0.1; }, [](MaterialSettings& m) { m.loss_factor = 0.31; }});
    material("bulk_viscosity", {[](MaterialSettings& m) { m.bulk_viscosity = -0.1; },
                                [](MaterialSettings& m) { m.bulk_viscosity = 1.1; }});
    judge_refusals("materials", list);
}

TEST_CASE("bodies, meshes and motions that are no numbers are refused by name, and leave the world as it was",
          "[scene][stress]") {
    World world;
    const auto rubber = world.add_material({});
    const Mesh box = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const auto body = world.add_body(box, {.material = rubber, .name = "good"});
    const std::uint64_t before = world.state_hash();
    std::vector<Refusal> list;
    for (const Real bad : {no_number, inf, -inf}) {
        for (Vec3 BodySettings::*member : {&BodySettings::position, &BodySettings::rotation, &BodySettings::velocity,
                                           &BodySettings::angular_velocity}) {
            BodySettings settings{.material = rubber, .name = "odd"};
            (settings.*member).z() = bad;
            list.push_back({"body 'odd'",
                            member == &BodySettings::position   ? "position"
                            : member == &BodySettings::rotation ? "rotation"
                                                                : "velocity",
                            [&, settings] { world.add_body(box, settings); }});
        }
        BodySettings settings{.material = rubber, .contact_distance = bad, .name = "odd"};
        list.push_back({"body 'odd'", "contact_distance", [&, settings] { world.add_body(box, settings); }});
        Mesh broken = box;
        broken.nodes[3].x() = bad;
        list.push_back(
            {"body 'odd'", "node 3", [&, broken] { world.add_body(broken, {.material = rubber, .name = "odd"}); }});
        const std::vector<Vec3> velocity(box.nodes.size(), Vec3(0, bad, 0));
        list.push_back({"set_velocities", "velocity", [&, velocity] { world.set_velocities(body, velocity); }});
        list.push_back({"set_loads", "load", [&, velocity] { world.set_loads(body, velocity); }});
        list.push_back({"gravity", "settings", [&, bad] { world.set_gravity({0, bad, 0}); }});
        list.push_back({"advance", "dt", [&, bad] { world.advance(bad); }});
        const std::vector<Index> node{0};
        list.push_back({"attachment", "pivot", [&, bad, node] { world.attach(body, node, {}, {bad, 0, 0}); }});
        list.push_back({"attachment", "motion.velocity", [&, bad, node] {
                            world.attach(body, node, {.velocity = {bad, 0, 0}});
                        }});
        list.push_back({"attachment", "motion.angular_velocity", [&, bad, node] {
                            world.attach(body, node, {.angular_velocity = {bad, 0, 0}});
                        }});
        list.push_back({"attachment", "motion.keys", [&, bad, node] {
                            world.attach(body, node, {.keys = {{0, {bad, 0, 0}, Vec3::Zero()}}});
                        }});
        list.push_back({"attachment", "motion.keys.time", [&, bad, node] {
                            world.attach(body, node, {.keys = {{bad, Vec3::Zero(), Vec3::Zero()}}});
                        }});
    }
    list.push_back({"body 'odd'", "contact_distance",
                    [&] { world.add_body(box, {.material = rubber, .contact_distance = -1, .name = "odd"}); }});
    list.push_back({"body 'odd'", "mesh", [&] { world.add_body(Mesh{}, {.material = rubber, .name = "odd"}); }});
    Mesh flat = box;
    for (Vec3& x : flat.nodes) x.z() = 0;
    list.push_back({"body 'odd'", "volume", [&] { world.add_body(flat, {.material = rubber, .name = "odd"}); }});
    Mesh turned = box;
    std::swap(turned.tetrahedra[2][0], turned.tetrahedra[2][1]);
    list.push_back({"tetrahedron 2", "volume", [&] { world.add_body(turned, {.material = rubber, .name = "odd"}); }});
    Mesh outside = box;
    outside.tetrahedra[1][2] = 99;
    list.push_back({"body 'odd'", "node 99", [&] { world.add_body(outside, {.material = rubber, .name = "odd"}); }});
    list.push_back({"add_body", "material", [&] { world.add_body(box, {.name = "odd"}); }});
    list.push_back({"advance", "dt", [&] { world.advance(-1); }});
    list.push_back({"attach", "node", [&] { world.attach(body, std::vector<Index>{99}); }});
    list.push_back({"attachment", "motion.keys.time", [&] {
                        world.attach(body, std::vector<Index>{0},
                                     {.keys = {{1, Vec3::Zero(), Vec3::Zero()}, {1, Vec3::Zero(), Vec3::Zero()}}});
                    }});
    list.push_back({"attachment", "motion.keys.rotation", [&] {
                        world.attach(body, std::vector<Index>{0}, {.keys = {{0, Vec3::Zero(), {0, 0, 1.1e6}}}});
                    }});
    list.push_back({"set_velocities", "velocity", [&] { world.set_velocities(body, std::vector<Vec3>(3)); }});
    list.push_back(
        {"watch_contact_problems", "every", [&] { world.watch_contact_problems([](const StepProblem&) {}, 0); }});
    list.push_back({"positions", "body", [&] { (void)world.positions({}); }});
    list.push_back({"remove", "collider", [&] { world.remove(ColliderHandle{}); }});
    judge_refusals("bodies, motions and calls", list);
    judge({18, "the world after all of them", "as before, to the bit", world.state_hash() == before ? "yes" : "no",
           world.state_hash() == before && world.bodies().size() == 1});
}

TEST_CASE("colliders that are no numbers or out of range are refused by name", "[scene][stress]") {
    World world;
    std::vector<Refusal> list;
    const auto shape = [&](const char* field, const Shape& bad) {
        list.push_back({"collider 'odd'", field, [&world, bad] { world.add_collider(bad, {.name = "odd"}); }});
    };
    const auto placed = [&](const char* field, ColliderSettings settings) {
        settings.name = "odd";
        list.push_back({"collider 'odd'", field, [&world, settings] { world.add_collider(Sphere{}, settings); }});
    };
    for (const Real bad : {no_number, inf, -inf, -1.0, 0.0}) {
        shape("radius", Sphere{bad});
        shape("size", Box{{1, bad, 1}});
        shape("radius", Capsule{bad, 1});
        shape("radius", Cylinder{bad, 1});
        shape("height", Cylinder{1, bad});
        shape("radius", Bucket{bad, 1, 1});
        shape("height", Bucket{1, bad, 1});
        shape("thickness", Bucket{1, 1, bad});
        if (bad == 0) continue;
        shape("length", Capsule{1, bad});
        placed("friction", {.friction = bad});
        placed("static_friction", {.static_friction = bad});
        placed("dynamic_friction", {.dynamic_friction = bad});
        placed("restitution", {.restitution = bad});
        placed("contact_distance", {.contact_distance = bad});
        if (bad == -1) continue;
        shape("normal", Plane{.normal = {0, bad, 0}});
        shape("point", Plane{.point = {bad, 0, 0}});
        placed("position", {.position = {bad, 0, 0}});
        placed("rotation", {.rotation = {bad, 0, 0}});
        placed("motion.velocity", {.motion = {.velocity = {bad, 0, 0}}});
        SurfaceMesh surface = mesh::boundary(mesh::box({1, 1, 1}, {1, 1, 1}));
        surface.nodes[2].y() = bad;
        shape("nodes", surface);
    }
    placed("restitution", {.restitution = 1.1});
    shape("normal", Plane{.normal = {0, 0, 0}});
    shape("triangles", SurfaceMesh{});
    judge_refusals("colliders", list);
}

TEST_CASE("finite values that are too large to compute with change nothing, and errors name their body",
          "[scene][stress]") {
    // Two separate bodies: an overflow in one must not affect the other.
    struct Case {
        const char* name;
        std::function<void(World&, MaterialHandle, const Mesh&)> add;
    };
    const std::vector<Case> cases{
        {"velocity of 1e200 m/s",
         [](World& w, MaterialHandle m, const Mesh& box) {
             w.add_body(box, {.material = m, .position = {5, 0, 1}, .velocity = {1e200, 0, 0}, .name = "odd"});
         }},
        {"position of 1e200 m",
         [](World& w, MaterialHandle m, const Mesh& box) {
             w.add_body(box, {.material = m, .position = {1e200, 0, 1}, .name = "odd"});
         }},
        {"spin of 1e200 rad/s",
         [](World& w, MaterialHandle m, const Mesh& box) {
             w.add_body(box, {.material = m, .position = {5, 0, 1}, .angular_velocity = {0, 1e200, 0}, .name = "odd"});
         }},
        {"modulus of 1e300 Pa",
         [](World& w, MaterialHandle, const Mesh& box) {
             w.add_body(box,
                        {.material = w.add_material({.young_modulus = 1e300}), .position = {5, 0, 1}, .name = "odd"});
         }},
        {"density of 1e308 kg/m^3",
         [](World& w, MaterialHandle, const Mesh& box) {
             w.add_body(box, {.material = w.add_material({.density = 1e308}), .position = {5, 0, 1}, .name = "odd"});
         }},
        {"load of 1e300 N",
         [](World& w, MaterialHandle m, const Mesh& box) {
             const auto body = w.add_body(box, {.material = m, .position = {5, 0, 1}, .name = "odd"});
             w.set_loads(body, std::vector<Vec3>(box.nodes.size(), Vec3(1e300, 0, 0)));
         }},
    };
    for (const Case& c : cases) {
        World world;
        const auto material = world.add_material({.young_modulus = 1e5});
        const Mesh box = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
        world.add_collider(Plane{});
        const auto good = world.add_body(box, {.material = material, .position = {0, 0, 0.06}, .name = "good"});
        std::string found;
        bool held = true;
        try {
            c.add(world, material, box);
            const std::uint64_t before = world.state_hash();
            const StepReport report = world.advance(1e-3);
            found = report.ok() ? "taken" : report.message();
            held = report.ok() ? all_finite(world)
                               : report.message().find("'odd'") != std::string::npos &&
                                     (report.steps > 0 || world.state_hash() == before);
        } catch (const SceneError& error) {
            found = error.what();
        }
        for (const Vec3& x : world.positions(good)) held = held && x.allFinite();
        judge({18, c.name, "refused by name, or taken and finite; the other body untouched", found, held});
    }
}

}  // namespace skerry::test::inputs_test
