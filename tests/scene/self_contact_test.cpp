// Bodies that touch themselves under strong deformation.
#include <catch2/catch.hpp>

#include "tests/support/crossing_ring.h"
#include "tests/support/mapped_box.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

namespace skerry::test::self_contact_test {

namespace {

constexpr Real pi = std::numbers::pi;

struct Driven {
    World world;
    BodyHandle body;
    int crossed = 0, most_contacts = 0;

    static Settings weightless() {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.start_overlaps = StartOverlaps::ignore;  // the folded sheet comes to lie where the floor is
        return settings;
    }
    Driven(const Mesh& mesh, bool self_contact, Real young_modulus) : world(weightless()) {
        const auto rubber =
            world.add_material({.young_modulus = young_modulus, .poisson_ratio = 0.3, .friction = 0.3, .damping = 30});
        body = world.add_body(mesh, {.material = rubber, .self_contact = self_contact, .name = "driven"});
    }
    void run(Real seconds) {
        for (Real t = 0; t < seconds - 1e-9; t += 0.01) {
            REQUIRE(world.advance(0.01).ok());
            crossed += self_crossings({world.positions(body), world.surface(body)}) > 0;
            most_contacts = std::max(most_contacts, static_cast<int>(world.contacts().size()));
        }
    }
};

/// A bar whose ends are twisted and pushed together. It buckles into a loop that lies on itself.
Driven twisted_bar(bool self_contact) {
    const Mesh bar = mesh::box({0.4, 0.03, 0.03}, {26, 2, 2});
    Driven driven(bar, self_contact, 2e5);
    const auto left = nodes_where(bar, [](const Vec3& x) { return x.x() < -0.199; });
    const auto right = nodes_where(bar, [](const Vec3& x) { return x.x() > 0.199; });
    driven.world.attach(driven.body, left, {.velocity = {0.12, 0, 0}, .angular_velocity = {-2 * pi, 0, 0}},
                        {-0.2, 0, 0});
    driven.world.attach(driven.body, right, {.velocity = {-0.12, 0, 0}, .angular_velocity = {2 * pi, 0, 0}},
                        {0.2, 0, 0});
    driven.run(1.2);
    return driven;
}

/// A sheet with one side folded over onto the other. A block then comes down and presses the loop flat.
Driven folded_sheet(bool self_contact) {
    const Mesh sheet = mesh::box({0.2, 0.08, 0.006}, {20, 8, 1});
    Driven driven(sheet, self_contact, 2e5);
    const auto left = nodes_where(sheet, [](const Vec3& x) { return x.x() < -0.091; });
    const auto right = nodes_where(sheet, [](const Vec3& x) { return x.x() > 0.091; });
    driven.world.attach(driven.body, left);
    const auto turning = driven.world.attach(driven.body, right, {.angular_velocity = {0, -2 * pi, 0}}, {0, 0, 0.005});
    driven.run(0.5);
    driven.world.remove(turning);
    driven.world.attach(driven.body, right);
    driven.world.add_collider(Plane{.normal = {0, 0, 1}, .point = {0, 0, -0.01}});
    // The lower face of the block stops 9 mm above the floor, less than the two layers of 6 mm need.
    driven.world.add_collider(Box{{0.16, 0.2, 0.05}},
                              {.position = {0.02, 0, 0.105}, .motion = {.velocity = {0, 0, -0.27}}});
    driven.run(0.3);
    return driven;
}

}  // namespace

TEST_CASE("a twisted and buckled bar with self-contact does not go through itself", "[scene][long]") {
    const Driven with = twisted_bar(true);
    CHECK(with.crossed == 0);
    CHECK(with.most_contacts > 5);
    CHECK(with.world.report().crossed == 0);
    CHECK(with.world.report().self_crossings.empty());
    CHECK(twisted_bar(false).crossed > 0);  // without self-contact it does, so the test can fail
}

TEST_CASE("a sheet folded onto itself and pressed down does not go through itself", "[scene][long]") {
    const Driven with = folded_sheet(true);
    CHECK(with.crossed == 0);
    CHECK(with.most_contacts > 10);
    CHECK(with.world.report().crossed == 0);
    CHECK(folded_sheet(false).crossed > 0);
}

TEST_CASE("a body that crosses itself is reported with the times, and no other body is", "[scene]") {
    CrossingRing ring;
    World& world = ring.world;
    REQUIRE(world.advance(0.1).ok());
    CHECK(world.report().self_crossings.empty());
    ring.close();
    REQUIRE(world.advance(0.6).ok());
    std::vector<SelfCrossing> found = world.report().self_crossings;
    REQUIRE(found.size() == 1);
    CHECK(found[0].body == ring.body);
    CHECK(found[0].name == "ring");
    CHECK(!found[0].self_contact);
    CHECK(found[0].first_time > 0.1);
    CHECK(found[0].first_time < 0.5);
    CHECK(found[0].last_time == world.time());
    CHECK(found[0].last_places > 0);
    CHECK(found[0].most_places == found[0].last_places);
    CHECK_THAT(found[0].message(), Catch::Contains("the surface of body 'ring' crosses itself in up to ") &&
                                       Catch::Contains("last at 0.7 s"));
    World copy = world.clone();
    ring.open();
    found = world.report().self_crossings;
    REQUIRE(found.size() == 1);
    CHECK(found[0].last_places == 0);
    CHECK(found[0].most_places > 0);
    CHECK(found[0].last_time < world.time());

    // A clone keeps the crossings that were found before, and finds those of its own steps.
    const std::vector<SelfCrossing> of_copy = copy.report().self_crossings;
    REQUIRE(of_copy.size() == 1);
    CHECK(of_copy[0].body == ring.body);
    CHECK(of_copy[0].first_time == found[0].first_time);
    CHECK(of_copy[0].most_places == found[0].most_places);
    CHECK(of_copy[0].last_time == copy.time());
}

}  // namespace skerry::test::self_contact_test
