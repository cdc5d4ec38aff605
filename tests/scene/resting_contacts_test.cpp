// Contacts of sleeping bodies. No step searches for them, but they stay available.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "engine/world/tuning.h"
#include "skerry/output.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::resting_contacts_test {

namespace {

/// Two stacked blocks on a plane, and one block beside them on a mesh collider.
struct Stack {
    World world;
    ColliderHandle floor, table;
    Mesh block = mesh::box({0.2, 0.2, 0.1}, {3, 3, 2});
    MaterialHandle rubber;
    BodyHandle low, high, beside;

    explicit Stack(const Settings& settings = sleepy(), const Tuning& tuning = {})
        : world(tuned_world(settings, tuning)) {
        rubber = world.add_material({.young_modulus = 1e5, .density = 500, .friction = 0.5, .damping = 20});
        floor = world.add_collider(Plane{});
        table = world.add_collider(SurfaceMesh{{{0.5, -0.5, 0}, {1.5, -0.5, 0}, {1, 0.7, 0}, {1, 0, -0.5}},
                                               {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}},
                                   {.position = {0, 0, 0.2}});
        low = add({0, 0, 0.0511});
        high = add({0.01, 0, 0.1534});
        beside = add({1, 0, 0.2511});
    }
    static Settings sleepy() {
        Settings settings;
        settings.sleep = true;
        return settings;
    }
    BodyHandle add(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
        return world.add_body(
            block, {.material = rubber, .position = position, .velocity = velocity, .contact_distance = 0.002});
    }
    bool all_rest() const { return world.report().asleep == world.bodies().size(); }
    /// Returns false if the bodies do not fall asleep within `most` seconds.
    bool settle(Real most = 12) {
        for (const Real end = world.time() + most; world.time() < end && !all_rest();)
            if (!world.advance(0.01).ok()) return false;
        return all_rest();
    }
    Vec3 force_on(BodyHandle body) const {
        Vec3 sum = Vec3::Zero();
        for (const Contact& contact : world.contacts()) {
            if (contact.first == body) sum += contact.force();
            if (contact.second == body) sum -= contact.force();
        }
        return sum;
    }
};

void check_same(const Contact& a, const Contact& b) {
    CHECK(a.first == b.first);
    CHECK(a.second == b.second);
    CHECK(a.collider == b.collider);
    CHECK(a.node == b.node);
    CHECK(a.weight == b.weight);
    CHECK(a.point == b.point);
    CHECK(a.normal == b.normal);
    CHECK(a.distance == b.distance);
    CHECK(a.gap == b.gap);
    CHECK(a.slip == b.slip);
    CHECK(a.motion == b.motion);
    CHECK((a.impulse * (b.seconds / a.seconds) - b.impulse).norm() <= 1e-15 * b.impulse.norm());
    CHECK(b.region == -1);
}

}  // namespace

TEST_CASE("contacts of resting bodies stay as in the last step before rest", "[scene]") {
    Stack stack;
    std::vector<Contact> last;
    stack.world.watch_steps([&](const StepReport& report) {
        if (report.contacts == 0) return;
        const auto now = stack.world.contacts();
        last.assign(now.begin(), now.end());
    });
    REQUIRE(stack.settle());
    stack.world.watch_steps({});
    for (const Real dt : {0.1, 0.0123}) {
        const StepReport report = stack.world.advance(dt);
        REQUIRE(report.ok());
        CHECK(report.contacts == 0);
        const auto now = stack.world.contacts();
        REQUIRE(now.size() == last.size());
        REQUIRE(now.size() > 20);
        for (std::size_t c = 0; c < now.size(); ++c) {
            // Bodies that fell asleep earlier no longer have a region.
            Contact before = last[c];
            before.region = -1;
            check_same(before, now[c]);
        }
        const Real weight = stack.world.mass(stack.low) * standard_gravity;
        CHECK(stack.force_on(stack.high).z() == Approx(weight).epsilon(0.02));
        CHECK(stack.force_on(stack.low).z() == Approx(weight).epsilon(0.02));
        CHECK(stack.force_on(stack.beside).z() == Approx(weight).epsilon(0.02));
    }
}

TEST_CASE("ParaView files contain the contacts of resting bodies, with their forces", "[scene]") {
    Stack stack;
    REQUIRE(stack.settle());
    const TemporaryFolder folder;
    VtkWriter writer(folder.path(), "rest");
    writer.write_frame(stack.world);
    const StepReport report = stack.world.advance(0.01);
    REQUIRE(report.contacts == 0);
    writer.write_frame(stack.world);
    writer.close();
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        if (entry.path().filename().string().find("_contacts_") != std::string::npos && last < entry.path())
            last = entry.path();
    std::ifstream file(last, std::ios::binary);
    REQUIRE(file.good());
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    CHECK_THAT(text, Catch::Contains("NumberOfPoints=\"" + std::to_string(stack.world.contacts().size()) + "\""));
}

TEST_CASE("support forces of resting bodies are known also when measuring starts later", "[scene]") {
    Stack stack;
    std::vector<Index> top;
    for (std::size_t n = 0; n < stack.block.nodes.size(); ++n)
        if (stack.block.nodes[n].z() > 0.049) top.push_back(static_cast<Index>(n));
    const auto hung = stack.add({-1, 0, 1});
    const auto hook = stack.world.attach(hung, top);
    const auto pair = stack.world.attach(hung, std::vector<Index>{top[0], top[5]});
    REQUIRE(stack.settle(20));
    stack.world.measure_forces(true);
    REQUIRE(stack.world.advance(0.05).ok());
    REQUIRE(stack.all_rest());
    const Real weight = stack.world.mass(stack.low) * standard_gravity;
    const Forces forces = stack.world.forces();
    CHECK(forces.on(stack.low, stack.floor).force().z() == Approx(2 * weight).epsilon(0.02));
    CHECK(forces.on(stack.high, stack.low).force().z() == Approx(weight).epsilon(0.02));
    CHECK(forces.on(stack.table).force().z() == Approx(-weight).epsilon(0.02));
    CHECK(forces.on(stack.table).contacts > 3);
    const Vec3 held = forces.by(hook).force() + forces.by(pair).force();
    CHECK(held.z() == Approx(weight).epsilon(0.02));
    CHECK(held.head<2>().norm() < 0.01 * weight);
    const Vec3 centre = stack.world.center_of_mass(hung);
    CHECK((forces.by(hook).moment_about(centre) + forces.by(pair).moment_about(centre)).norm() < 0.01 * weight * 0.1);
    CHECK(forces.by(pair).force().norm() > 0);
    // The forces stay the same when all bodies are awake again.
    for (const BodyHandle body : stack.world.bodies()) stack.world.wake(body);
    REQUIRE(stack.world.advance(0.05).ok());
    CHECK(stack.world.forces().on(stack.high, stack.low).force().z() == Approx(weight).epsilon(0.02));
    CHECK(stack.world.forces().by(pair).force().z() == Approx(forces.by(pair).force().z()).epsilon(0.02));
}

TEST_CASE("when a body wakes, its contacts are those of the step, beside the contacts of resting bodies", "[scene]") {
    Stack stack;
    REQUIRE(stack.settle());
    stack.world.wake(stack.low);
    REQUIRE(stack.world.advance(1e-4).ok());
    CHECK_FALSE(stack.world.asleep(stack.high));  // the impulse between the blocks has woken it
    CHECK(stack.world.asleep(stack.beside));
    // The contacts of the block beside are shown together with those of this step.
    const auto contacts = stack.world.contacts();
    const auto of = [&](BodyHandle body) {
        return std::ranges::count_if(contacts,
                                     [body](const Contact& c) { return c.first == body || c.second == body; });
    };
    CHECK(of(stack.low) > 10);
    CHECK(of(stack.beside) > 3);
    for (const Contact& contact : contacts)
        CHECK((contact.region == -1) == (contact.first == stack.beside || contact.second == stack.beside));
}

TEST_CASE("a removed resting body takes its contacts along, and other contacts keep their names", "[scene]") {
    Stack stack;
    REQUIRE(stack.settle());
    REQUIRE(stack.world.advance(0.01).ok());
    const auto of_beside = [&] {
        std::vector<Contact> found;
        for (const Contact& c : stack.world.contacts())
            if (c.first == stack.beside || c.second == stack.beside) found.push_back(c);
        return found;
    };
    const std::vector<Contact> before = of_beside();
    REQUIRE(before.size() > 3);
    stack.world.remove(stack.low);
    const std::vector<Contact> after = of_beside();
    REQUIRE(after.size() == before.size());
    for (std::size_t c = 0; c < after.size(); ++c) check_same(before[c], after[c]);
    CHECK(stack.world.contacts().size() == after.size());
    REQUIRE(stack.world.advance(0.05).ok());
    CHECK(stack.world.asleep(stack.beside));
    CHECK(of_beside().size() == before.size());
}

TEST_CASE("worlds at rest that are cloned, saved and loaded show the same contacts and wake to the same bits",
          "[scene]") {
    Stack stack;
    REQUIRE(stack.settle());
    REQUIRE(stack.world.advance(0.01).ok());
    const TemporaryFolder folder;
    stack.world.save(folder.path() / "rest.skerry");
    World loaded = World::load(folder.path() / "rest.skerry", {.threads = 2}), cloned = stack.world.clone();
    const auto expect_same = [&] {
        for (const World* other : {&loaded, &cloned}) {
            CHECK(other->state_hash() == stack.world.state_hash());
            const auto expected = stack.world.contacts(), found = other->contacts();
            REQUIRE(found.size() == expected.size());
            for (std::size_t c = 0; c < found.size(); ++c) {
                CHECK(found[c].node == expected[c].node);
                CHECK(found[c].point == expected[c].point);
                CHECK(found[c].gap == expected[c].gap);
                CHECK(found[c].slip == expected[c].slip);
                CHECK(found[c].impulse == expected[c].impulse);
                CHECK(found[c].region == expected[c].region);
            }
        }
    };
    REQUIRE(stack.world.contacts().size() > 20);
    expect_same();
    for (World* world : {&stack.world, &loaded, &cloned}) REQUIRE(world->advance(0.0217).ok());
    expect_same();
    CHECK(loaded.report().resting_steps == stack.world.report().resting_steps);
    for (World* world : {&stack.world, &loaded, &cloned}) {
        world->wake(stack.low);
        REQUIRE(world->advance(0.02).ok());
    }
    CHECK_FALSE(stack.world.asleep(stack.high));
    expect_same();
}

// Steps in which no stage runs

TEST_CASE("a step that nothing moves in is left out, with the bits that its stages would leave", "[scene][long]") {
    for (const Integrator integrator : {Integrator::symplectic_euler, Integrator::leapfrog}) {
        Settings settings = Stack::sleepy();
        settings.integrator = integrator;
        Stack quick(settings), slow(settings, {.contact_budgets = false});
        // A distant box that moves once.
        for (Stack* stack : {&quick, &slow})
            stack->world.add_collider(
                Box{{0.1, 0.1, 0.1}},
                {.motion = {.keys = {{.time = 4.0, .position = {5, 5, 5}}, {.time = 4.1, .position = {5, 5, 6}}}}});
        for (int call = 0; call < 300; ++call) {
            const Real dt = 0.015 + 0.001 * (call % 3);
            REQUIRE(quick.world.advance(dt).ok());
            REQUIRE(slow.world.advance(dt).ok());
            CAPTURE(call, quick.world.report().asleep);
            REQUIRE(quick.world.state_hash() == slow.world.state_hash());
        }
        CHECK(quick.world.report().resting_steps > 100);
        CHECK(slow.world.report().resting_steps == 0);
        CHECK(quick.world.report().steps == slow.world.report().steps);
        CHECK(quick.world.report().energy_error == slow.world.report().energy_error);
        CHECK(quick.world.report().balanced_steps == slow.world.report().balanced_steps);
        quick.add({0.02, 0, 0.27}, {0, 0, -0.3});
        slow.add({0.02, 0, 0.27}, {0, 0, -0.3});
        for (int call = 0; call < 20; ++call) {
            REQUIRE(quick.world.advance(0.01).ok());
            REQUIRE(slow.world.advance(0.01).ok());
            REQUIRE(quick.world.state_hash() == slow.world.state_hash());
        }
        CHECK_FALSE(quick.world.asleep(quick.low));
        CHECK(quick.world.asleep(quick.beside));
    }
}

TEST_CASE("a collider that begins to move ends the steps that are left out", "[scene]") {
    Stack stack;
    // A box that comes down from above.
    stack.world.add_collider(Box{{0.1, 0.1, 0.1}}, {.motion = {.keys = {{.time = 0, .position = {0, 0, 1}},
                                                                        {.time = 12, .position = {0, 0, 1}},
                                                                        {.time = 13, .position = {0, 0, 0.2}}}}});
    REQUIRE(stack.settle(11));
    REQUIRE(stack.world.advance(12 - stack.world.time()).ok());
    REQUIRE(stack.all_rest());
    const std::uint64_t skipped_steps = stack.world.report().resting_steps;
    CHECK(skipped_steps > 0);
    REQUIRE(stack.world.advance(1).ok());
    CHECK_FALSE(stack.world.asleep(stack.high));
    CHECK(stack.world.asleep(stack.beside));
    CHECK(stack.world.center_of_mass(stack.high).z() < 0.152);
    CHECK(stack.world.report().resting_steps == skipped_steps);
}

}  // namespace skerry::test::resting_contacts_test
