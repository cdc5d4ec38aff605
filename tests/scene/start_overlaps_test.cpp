// Overlaps before the first step are found and named. They are resolved, refused or reported, depending on the
// settings.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "systems/geometry/rotation.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

namespace skerry::test::start_overlaps_test {

using Catch::Contains;

namespace {

Settings weightless(StartOverlaps overlaps) {
    Settings settings;
    settings.gravity = Vec3::Zero();
    settings.start_overlaps = overlaps;
    return settings;
}

/// A world and a material for the bodies that are added.
struct Stage {
    World world;
    MaterialHandle rubber;

    explicit Stage(StartOverlaps overlaps) : world(weightless(overlaps)), rubber(world.add_material({})) {}

    BodyHandle add(const Mesh& mesh, const Vec3& position, const std::string& name) {
        return world.add_body(mesh, {.material = rubber, .position = position, .name = name});
    }
    std::vector<Vec3> copy_of(BodyHandle body) const {
        return {world.positions(body).begin(), world.positions(body).end()};
    }
};

/// A case that must be refused: a function that builds it, and a part of the message.
struct Refused {
    const char* name;
    void (*build)(Stage&);
    const char* said;
};

const std::vector<Refused> hopeless{
    {"coincident balls",
     [](Stage& s) {
         s.add(mesh::ball(0.1, 4), {0, 0, 0.2}, "one");
         s.add(mesh::ball(0.1, 4), {0, 0, 0.2}, "other");
     },
     "bodies 'one' and 'other' coincide at (0, 0, 0.2) m"},
    {"boxes of one cell that coincide",
     [](Stage& s) {
         s.add(mesh::box({1, 1, 1}, {1, 1, 1}), Vec3::Zero(), "one");
         s.add(mesh::box({1, 1, 1}, {1, 1, 1}), Vec3::Zero(), "other");
     },
     "bodies 'one' and 'other' coincide at"},
    {"a ball in a ball",
     [](Stage& s) {
         s.add(mesh::ball(0.1, 4), {0, 0, 0.2}, "large");
         s.add(mesh::ball(0.03, 4), {0, 0, 0.2}, "small");
     },
     "body 'small' is inside body 'large' at (0, 0, 0.2) m"},
    {"balls whose centres are 20 mm apart",
     [](Stage& s) {
         s.add(mesh::ball(0.1, 4), {0, 0, 0.2}, "one");
         s.add(mesh::ball(0.1, 4), {0.02, 0, 0.2}, "other");
     },
     "bodies 'one' and 'other' overlap by"},
    {"a ball in a mesh box",
     [](Stage& s) {
         s.add(mesh::ball(0.05, 4), {0, 0, 0.2}, "ball");
         s.world.add_collider(mesh::boundary(mesh::box({1, 1, 1}, {4, 4, 4})), {.motion = {}, .name = "room"});
     },
     "body 'ball' is inside collider 'room' at (0, 0, 0.2) m"},
    {"a ball far below a plane",
     [](Stage& s) {
         s.add(mesh::ball(0.1, 4), {0, 0, -5}, "ball");
         s.world.add_collider(Plane{}, {.motion = {}, .name = "floor"});
     },
     "body 'ball' is inside collider 'floor' at (0, 0, -5) m, 5.1 m deep"},
    {"a collider in a ball",
     [](Stage& s) {
         s.add(mesh::ball(0.1, 4), {0, 0, 0.2}, "ball");
         s.world.add_collider(Sphere{0.01}, {.position = {0, 0.01, 0.2}, .motion = {}, .name = "pea"});
     },
     "collider 'pea' is inside body 'ball'"},
};

Real largest_move(const std::vector<Vec3>& before, std::span<const Vec3> after) {
    Real largest = 0;
    for (std::size_t n = 0; n < before.size(); ++n) largest = std::max(largest, (after[n] - before[n]).norm());
    return largest;
}

/// Brute-force overlap test after moving `b` by `shift`: surfaces cross, or a node of one body is in a tetrahedron of
/// the other.
bool overlap_by_force(const World& world, BodyHandle a, BodyHandle b, const Vec3& shift = Vec3::Zero()) {
    const std::vector<Vec3> fixed(world.positions(a).begin(), world.positions(a).end());
    std::vector<Vec3> moved(world.positions(b).begin(), world.positions(b).end());
    for (Vec3& x : moved) x += shift;
    if (crossings({fixed, world.surface(a)}, {moved, world.surface(b)}) > 0) return true;
    const auto inside = [](std::span<const Vec3> inner, std::span<const Vec3> corner,
                           std::span<const std::array<Index, 4>> tetrahedra) {
        for (const Vec3& x : inner)
            for (const auto& t : tetrahedra) {
                const auto at = [&](std::size_t k) { return corner[static_cast<std::size_t>(t[k])]; };
                if (orientation(at(0), at(1), at(2), x) > 0 && orientation(at(0), at(3), at(1), x) > 0 &&
                    orientation(at(0), at(2), at(3), x) > 0 && orientation(at(1), at(3), at(2), x) > 0)
                    return true;
            }
        return false;
    };
    return inside(fixed, moved, world.tetrahedra(b)) || inside(moved, fixed, world.tetrahedra(a));
}

/// True if no small shift separates two bodies. Overlaps up to a tenth of the contact distance count as touching.
bool overlap_by_more_than_touching(const World& world, BodyHandle a, BodyHandle b) {
    const Real slack = 0.1 * (world.contact_distance(a) + world.contact_distance(b));  // twice that, in 26 directions
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (!overlap_by_force(world, a, b, slack * Vec3(x, y, z).stableNormalized())) return false;
    return true;
}

}  // namespace

TEST_CASE("bodies inside each other are refused by both names, and nothing changes", "[scene]") {
    for (const Refused& c : hopeless)
        for (StartOverlaps overlaps : {StartOverlaps::resolve, StartOverlaps::refuse}) {
            Stage s(overlaps);
            c.build(s);
            INFO(c.name << ", " << name_of(overlaps));
            const std::vector<Vec3> before = s.copy_of(s.world.bodies().front());
            CHECK_THROWS_WITH(s.world.advance(1e-3), Contains(c.said) && Contains("start_overlaps: found"));
            CHECK_THROWS_WITH(s.world.settle_start(), Contains(c.said));  // again, as nothing has changed
            CHECK(s.world.time() == 0);
            CHECK(largest_move(before, s.world.positions(s.world.bodies().front())) == 0);
            CHECK(s.world.report().start_overlaps.empty());
        }
}

TEST_CASE("ignored overlaps are reported, and the run begins as it is", "[scene]") {
    for (const Refused& c : hopeless) {
        Stage s(StartOverlaps::ignore);
        c.build(s);
        INFO(c.name);
        const std::vector<Vec3> before = s.copy_of(s.world.bodies().front());
        s.world.settle_start();
        CHECK(largest_move(before, s.world.positions(s.world.bodies().front())) == 0);
        REQUIRE(s.world.report().start_overlaps.size() == 1);
        const StartOverlap overlap = s.world.report().start_overlaps.front();
        CHECK_THAT(overlap.message(), Contains(c.said));
        CHECK_FALSE(overlap.resolved);
        CHECK(overlap.depth > 0.005);
        CHECK(s.world.alive(overlap.first));
        CHECK(s.world.alive(overlap.second) != s.world.alive(overlap.collider));
        CHECK(s.world.advance(1e-4).ok());
        CHECK(s.world.report().start_overlaps.size() == 1);
    }
}

TEST_CASE("a shallow overlap is taken apart by the shortest way, as much as masses say, and costs no energy",
          "[scene]") {
    Stage s(StartOverlaps::resolve);
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {3, 3, 3});
    const auto light = s.add(mesh, {0, 0, 0}, "light");
    const auto heavy = s.world.add_body(
        mesh, {.material = s.world.add_material({.density = 3000}), .position = {0.01, 0.095, 0.02}, .name = "heavy"});
    const Real shell = s.world.contact_distance(light);
    s.world.settle_start();
    const WorldReport report = s.world.report();
    REQUIRE(report.start_overlaps.size() == 1);
    const StartOverlap& overlap = report.start_overlaps.front();
    CHECK(overlap.resolved);
    CHECK(overlap.kind == OverlapKind::crossing);
    CHECK(overlap.depth == Approx(0.005));
    CHECK(overlap.place.y() == Approx(0.0475).margin(0.001));
    REQUIRE(report.start_moves.size() == 2);
    CHECK(report.start_moves[0].translation.y() == Approx(-0.75 * (0.005 + shell)));
    CHECK(report.start_moves[1].translation.y() == Approx(0.25 * (0.005 + shell)));
    CHECK(s.world.center_of_mass(light).x() == Approx(0).margin(1e-12));
    CHECK_FALSE(overlap_by_force(s.world, light, heavy));
    REQUIRE(s.world.advance(0.1).ok());
    const Energy energy = s.world.energy();
    CHECK(energy.kinetic + energy.elastic < 1e-12);
    CHECK(s.world.report().max_penetration == 0);
    CHECK(s.world.report().start_moves.size() == 2);
}

TEST_CASE("bodies without a contact distance are moved until they touch", "[scene]") {
    Stage s(StartOverlaps::resolve);
    std::vector<BodyHandle> row;
    for (int i = 0; i < 4; ++i)
        row.push_back(s.world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                                       {.material = s.rubber, .position = {0.09 * i, 0, 0}, .contact_distance = 0}));
    s.world.settle_start();
    CHECK(s.world.report().start_overlaps.size() == 3);
    for (std::size_t i = 1; i < row.size(); ++i)
        CHECK(s.world.center_of_mass(row[i]).x() - s.world.center_of_mass(row[i - 1]).x() == Approx(0.1).margin(1e-9));
}

TEST_CASE("a body a bit in any collider is lifted out of it", "[scene]") {
    const Mesh mesh = mesh::box({0.2, 0.2, 0.2}, {2, 2, 2});
    struct Case {
        Shape shape;
        Vec3 touching;
    };
    const std::vector<Case> cases{
        {Plane{}, {0, 0, 0.1}},
        {Sphere{0.5}, {0, 0, 0.6}},
        {Box{{1, 1, 1}}, {0.6, 0, 0}},
        {Capsule{0.3, 0.6}, {0, 0.4, 0}},
        {Cylinder{0.5, 0.6}, {0, 0, 0.4}},
        {Bucket{0.5, 0.6, 0.05}, {0, 0, 0.1}},
        {mesh::boundary(mesh::box({1, 1, 1}, {2, 2, 2})), {0, -0.6, 0}},
    };
    for (const Case& c : cases)
        for (Real depth : {0.0, 1e-10, 0.004}) {
            Stage s(StartOverlaps::resolve);
            const Vec3 out = c.touching.normalized();
            const auto body = s.add(mesh, c.touching - depth * out, "block");
            const auto collider = s.world.add_collider(c.shape, {.motion = {}, .name = "fixture"});
            s.world.settle_start();
            INFO("shape " << c.shape.index() << ", depth " << depth);
            const WorldReport report = s.world.report();
            REQUIRE(report.start_overlaps.size() == (depth > 1e-9 ? 1 : 0));
            REQUIRE(report.start_moves.size() == report.start_overlaps.size());
            if (report.start_overlaps.empty()) continue;
            CHECK(report.start_overlaps[0].collider == collider);
            CHECK_THAT(report.start_overlaps[0].message(),
                       Contains("body 'block' and collider 'fixture' overlap by 0.004 m"));
            CHECK(report.start_moves[0].translation.norm() < 0.004 + s.world.contact_distance(body));
            CHECK(report.start_moves[0].translation.dot(out) > 0.004);
            s.world.advance(1e-6);
            CHECK(s.world.report().max_penetration == 0);
        }
}

TEST_CASE("a body that something sharp is in between its nodes is lifted off it", "[scene]") {
    const Mesh mesh = mesh::box({0.2, 0.2, 0.2}, {2, 2, 2});
    struct Case {
        const char* name;
        Shape shape;
        Vec3 tip, out;  // deepest point in the body [m]; outward direction, not normalised
    };
    const std::vector<Case> cases{
        {"corner", Box{{1, 1, 1}}, {0.5, 0.5, 0.5}, {1, 1, 1}},
        {"edge", Box{{1, 1, 1}}, {0.5, 0.5, 0.1}, {1, 1, 0}},
        {"bead", Sphere{0.02}, {0, 0, 0.02}, {0, 0, 1}},
        {"end", Capsule{0.02, 0.6}, {0, 0, 0.32}, {0, 0, 1}},
        {"rim of a cylinder", Cylinder{0.5, 0.6}, {0.5, 0, 0.3}, {1, 0, 1}},
        {"rim of a bucket", Bucket{0.5, 0.6, 0.05}, {0.55, 0, 0.6}, {1, 0, 1}},
    };
    for (const Case& c : cases)
        for (Real depth : {0.0, 0.004}) {
            Stage s(StartOverlaps::resolve);
            const Vec3 out = c.out.normalized();
            const Mat3 turned = rotation_between(Vec3::UnitZ(), out);
            const Vec3 position = c.tip + (0.1 - depth) * out + turned * Vec3(0.03, 0.045, 0);
            const auto body = s.world.add_body(
                mesh,
                {.material = s.rubber, .position = position, .rotation = rotation_vector(turned), .name = "block"});
            const auto collider = s.world.add_collider(c.shape, {.motion = {}, .name = "fixture"});
            s.world.settle_start();
            INFO(c.name << ", depth " << depth);
            const WorldReport report = s.world.report();
            REQUIRE(report.start_overlaps.size() == (depth > 0 ? 1 : 0));
            if (report.start_overlaps.empty()) continue;
            CHECK(report.start_overlaps[0].collider == collider);
            // The depth is the shortest way out for one point, not for the whole body.
            CHECK(report.start_overlaps[0].depth > 0.1 * depth);
            CHECK(report.start_overlaps[0].depth < 1.001 * depth);
            REQUIRE(report.start_moves.size() == 1);
            CHECK(report.start_moves[0].translation.norm() < 0.004 + s.world.contact_distance(body));
            // The remaining overlap counts as touching.
            const Real touching = 0.05 * s.world.contact_distance(body);
            CHECK(report.start_moves[0].translation.dot(out) > 0.004 - touching);
            s.world.advance(1e-6);
            CHECK(s.world.report().max_penetration < touching);
        }
}

TEST_CASE("bodies that touch, or are within the contact distance, do not overlap", "[scene]") {
    for (Real gap : {0.0, 1e-12, -1e-12, 1e-3}) {
        Stage s(StartOverlaps::refuse);
        for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.1 + gap, 0, 0), Vec3(0, 0.1 + gap, 0.1 + gap), Vec3(0.07, 0.1, 0)})
            s.add(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), at + Vec3(7.7, 3.3, 0.05), "box at " + std::to_string(at.x()));
        s.world.add_collider(Plane{});
        CHECK(s.world.advance(1e-4).ok());
        CHECK(s.world.report().start_overlaps.empty());
    }
}

TEST_CASE("a body that touches the back of an open surface is lifted off it and stays there", "[scene]") {
    const SurfaceMesh sheet{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 2, 1}, {0, 3, 2}}};
    for (const BodyDynamics dynamics : {BodyDynamics::explicit_elastic, BodyDynamics::rigid}) {
        World world;
        world.add_collider(sheet, {.name = "sheet"});
        const BodyHandle body =
            world.add_body(mesh::box({0.2, 0.2, 0.2}, {2, 2, 2}),
                           {.material = world.add_material({}), .position = {0.1, 0.05, 0.1}, .dynamics = dynamics});
        REQUIRE(world.advance(0.2).ok());
        REQUIRE(world.report().start_moves.size() == 1);
        CHECK(world.report().start_moves[0].translation.z() > 0);
        CHECK(std::abs(world.center_of_mass(body).z() - 0.1) < 0.005);
    }
}

TEST_CASE("a mesh collider oriented inwards is a room, in which bodies may start", "[scene]") {
    SurfaceMesh room = mesh::boundary(mesh::box({1, 1, 1}, {4, 4, 4}));
    for (auto& triangle : room.triangles) std::swap(triangle[0], triangle[1]);
    World world;
    const auto rubber = world.add_material({});
    const auto ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0.02, 0.03, -0.4}});
    world.add_collider(room);
    REQUIRE(world.advance(0.5).ok());
    CHECK(world.report().start_overlaps.empty());
    CHECK(world.center_of_mass(ball).z() == Approx(-0.45).margin(0.01));  // the ball lies on a facet
}

TEST_CASE("only new bodies are moved: held bodies and those that have made a step stay", "[scene]") {
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    Stage s(StartOverlaps::resolve);
    const auto old = s.add(mesh, {0, 0, 0}, "old");
    REQUIRE(s.world.advance(1e-3).ok());
    const std::vector<Vec3> before = s.copy_of(old);
    const auto added = s.add(mesh, {0.01, 0, 0.099}, "added");
    s.world.settle_start();
    CHECK(largest_move(before, s.world.positions(old)) == 0);
    CHECK(s.world.center_of_mass(added).z() > 0.1);
    REQUIRE(s.world.report().start_moves.size() == 1);
    CHECK(s.world.report().start_moves[0].body == added);

    Stage held(StartOverlaps::resolve);
    std::vector<Index> all(mesh.nodes.size());
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<Index>(n);
    held.world.attach(held.add(mesh, {0, 0, 0}, "one"), all);
    const auto other = held.add(mesh, {0.01, 0, 0.099}, "other");
    held.world.attach(other, all);
    CHECK_THROWS_WITH(held.world.settle_start(), Contains("neither object can be moved"));
    held.world.remove(other);
    CHECK(held.world.advance(1e-4).ok());
}

TEST_CASE("a body that the push would drive into its neighbour pushes that one, too", "[scene]") {
    Stage s(StartOverlaps::resolve);
    const Mesh mesh = mesh::box({0.1, 0.1, 0.1}, {2, 2, 2});
    std::vector<BodyHandle> row;
    for (int i = 0; i < 8; ++i) row.push_back(s.add(mesh, {0, 0, 0.099 * i}, "box " + std::to_string(i)));
    s.world.add_collider(Plane{.point = {0, 0, -0.05}});
    s.world.settle_start();
    CHECK(s.world.report().start_overlaps.size() == 7);
    for (std::size_t i = 1; i < row.size(); ++i)
        CHECK(s.world.center_of_mass(row[i]).z() - s.world.center_of_mass(row[i - 1]).z() > 0.1);
    CHECK(s.world.center_of_mass(row[0]).z() > 0);
}

TEST_CASE("without room to move to the start is refused", "[scene]") {
    Stage s(StartOverlaps::resolve);
    s.add(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}), {0, 0, 0}, "wedged");
    s.world.add_collider(Plane{.point = {0, 0, -0.045}});
    s.world.add_collider(Plane{.normal = {0, 0, -1}, .point = {0, 0, 0.045}});
    CHECK_THROWS_WITH(s.world.settle_start(), Contains("'wedged'") && Contains("leave no room to move them apart"));
}

TEST_CASE("random piles overlap where a search by force says so, and nowhere once they are taken apart", "[scene]") {
    Random random(5);
    int overlapping = 0, resolved = 0;
    for (int pile = 0; pile < 24; ++pile) {
        Stage found(StartOverlaps::ignore), moved(StartOverlaps::resolve);
        for (int i = 0; i < 12; ++i) {
            const Vec3 at = Vec3(i % 3, i / 3 % 2, i / 6) + (pile < 12 ? 0.05 : 0.5) * random.vector();
            const Mesh mesh = i % 2 ? mesh::ball(0.5, 2) : mesh::box({0.9, 1, 0.95}, {1, 1, 1});
            for (Stage* s : {&found, &moved}) s->add(mesh, at, "body " + std::to_string(i));
        }
        found.world.settle_start();
        const std::vector<BodyHandle> bodies = found.world.bodies();
        std::vector<std::pair<BodyHandle, BodyHandle>> expected, got;
        for (std::size_t a = 0; a < bodies.size(); ++a)
            for (std::size_t b = a + 1; b < bodies.size(); ++b)
                if (overlap_by_force(found.world, bodies[a], bodies[b])) expected.emplace_back(bodies[a], bodies[b]);
        for (const StartOverlap& o : found.world.report().start_overlaps) {
            got.emplace_back(o.first, o.second);
            CHECK(std::ranges::find(expected, got.back()) != expected.end());
        }
        // Overlaps that are too shallow count as touching and may be missing.
        CHECK(10 * got.size() >= 9 * expected.size());
        overlapping += static_cast<int>(got.size());
        try {
            moved.world.settle_start();
        } catch (const SceneError&) {
            continue;
        }
        ++resolved;
        for (std::size_t a = 0; a < bodies.size(); ++a)
            for (std::size_t b = a + 1; b < bodies.size(); ++b)
                CHECK_FALSE(
                    overlap_by_more_than_touching(moved.world, moved.world.bodies()[a], moved.world.bodies()[b]));
    }
    CHECK(overlapping > 100);
    CHECK(resolved >= 8);
}

TEST_CASE("a world without overlaps has the same bits for all values of start_overlaps", "[scene]") {
    std::vector<std::uint64_t> hashes;
    for (StartOverlaps overlaps : {StartOverlaps::resolve, StartOverlaps::refuse, StartOverlaps::ignore}) {
        Stage s(overlaps);
        s.add(mesh::ball(0.1, 4), {0, 0, 0}, "one");
        s.add(mesh::ball(0.1, 4), {0.19, 0.08, 0}, "other");
        REQUIRE(s.world.advance(0.01).ok());
        hashes.push_back(s.world.state_hash());
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
}

}  // namespace skerry::test::start_overlaps_test
