// Times at which moving nodes, edges and faces touch moving colliders, against sampling of many times and places.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/time_of_touch.h"
#include "systems/collision/narrow/collider_distance.h"
#include "systems/geometry/rotation.h"
#include "systems/geometry/time_of_contact.h"
#include "tests/support/draws.h"
#include "tests/support/random.h"

namespace skerry::test::time_of_touch_test {

using test::Random;
using Kind = TouchingFeature::Kind;

namespace {

constexpr Real h = 0.01;  // [s]
constexpr int times = 100, places = 30;

struct Named {
    const char* name;
    ColliderGeometry geometry;
};

const Named shapes[] = {
    {"sphere", {ColliderShape::sphere, {0.3, 0, 0}}},      {"bead", {ColliderShape::sphere, {0.02, 0, 0}}},
    {"box", {ColliderShape::box, {0.2, 0.3, 0.4}}},        {"plate", {ColliderShape::box, {0.4, 0.01, 0.4}}},
    {"capsule", {ColliderShape::capsule, {0.05, 0.4, 0}}}, {"cylinder", {ColliderShape::cylinder, {0.3, 0.2, 0}}},
    {"disc", {ColliderShape::cylinder, {0.4, 0.01, 0}}},   {"bucket", {ColliderShape::bucket, {0.4, 0.5, 0.02}}},
};

struct Scene {
    RigidMotion motion;
    TouchingFeature feature;

    /// Positions of the feature's nodes in the frame of the collider, at a fraction of the step.
    std::array<Vec3, 3> at(Real time) const {
        const Mat3 rotation = rotation_matrix(time * h * motion.angular_velocity) * motion.rotation;
        std::array<Vec3, 3> local;
        for (std::size_t i = 0; i < feature.nodes(); ++i)
            local[i] = rotation.transpose() * (feature.position[i] + time * feature.displacement[i] -
                                               (motion.position + time * h * motion.velocity));
        return local;
    }
};

/// A scene whose feature passes near `aim`, a point in the frame of the collider [m].
Scene random_scene(Random& random, Kind kind, Index part_or_point, const Vec3& aim, bool turning) {
    Scene scene;
    scene.motion = {random.vector(), random.rotation(), 30 * random.vector(), Vec3::Zero()};
    if (turning) scene.motion.angular_velocity = 30 * random.vector();
    scene.feature.kind = kind;
    scene.feature.part_or_point = part_or_point;
    const Vec3 middle = 0.8 * random.vector(), flight = 1.5 * (aim - middle);
    for (std::size_t i = 0; i < scene.feature.nodes(); ++i) {
        scene.feature.position[i] = scene.motion.position + scene.motion.rotation * (middle + 0.3 * random.vector());
        scene.feature.displacement[i] =
            h * scene.motion.velocity + scene.motion.rotation * (flight + 0.1 * random.vector());
    }
    return scene;
}

/// A random point of the collider, or at most 0.02 m outside.
Vec3 inside(Random& random, const ColliderGeometry& geometry) {
    for (;;) {
        const Vec3 point = 0.6 * random.vector();
        if (local_distance(geometry, point).distance < 0.02) return point;
    }
}

/// Signed distance of a node or an edge to the part [m].
Real sampled_distance(const ColliderGeometry& geometry, Index part, const std::array<Vec3, 3>& nodes, Kind kind) {
    if (kind == Kind::node) return local_distance(geometry, nodes[0], part).distance;
    Real least = std::numeric_limits<Real>::infinity();
    for (int i = 0; i <= places; ++i) {
        const Vec3 at = nodes[0] + static_cast<Real>(i) / places * (nodes[1] - nodes[0]);
        least = std::min(least, local_distance(geometry, at, part).distance);
    }
    return least;
}

/// Position of a collider point relative to a face.
struct Side {
    Real height;    // height in front of the face [m]
    bool above;     // its projection is inside the face
    Real distance;  // distance to the face [m]
};

Side side_of(const Vec3& point, const std::array<Vec3, 3>& corner) {
    const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    const PointTriangle closest = closest_point_on_triangle(point, corner[0], corner[1], corner[2]);
    return {normal.dot(point - corner[0]), closest.region == TriangleRegion::face, std::sqrt(closest.distance_squared)};
}

/// Positions on the collider that point k represents.
std::vector<Vec3> places_of_point(const ColliderGeometry& geometry, Index k) {
    if (!is_moving_rim_point(geometry.shape, k)) return {collider_point(geometry, k, Vec3::Zero()).at};
    std::vector<Vec3> rim;
    for (int i = 0; i < 180; ++i) {
        const Real angle = 2 * std::numbers::pi * i / 180;
        rim.push_back(collider_point(geometry, k, Vec3(std::cos(angle), std::sin(angle), 0)).at);
    }
    return rim;
}

struct Seen {
    bool enters = false;                                   // a point enters between two times while no edge is near
    Real nearest = std::numeric_limits<Real>::infinity();  // smallest distance [m]
};

Seen look_at_face(const ColliderGeometry& geometry, const Scene& scene, Real near_edges) {
    const Index k = scene.feature.part_or_point;
    const Real radius = collider_point(geometry, k, Vec3::UnitX()).radius;
    const std::vector<Vec3> place = places_of_point(geometry, k);
    std::vector<Side> before(place.size());
    Seen seen;
    for (int t = 0; t <= times; ++t) {
        const auto corner = scene.at(static_cast<Real>(t) / times);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::array<Vec3, 3> edge{corner[i], corner[(i + 1) % 3], Vec3::Zero()};
            if (sampled_distance(geometry, no_index, edge, Kind::edge) < near_edges) return seen;
        }
        for (std::size_t i = 0; i < place.size(); ++i) {
            const Side now = side_of(place[i], corner);
            const bool through = radius > 0
                                     ? now.distance < radius && now.above
                                     : t > 0 && now.above && before[i].above && now.height * before[i].height < 0;
            seen.enters = seen.enters || through;
            seen.nearest = std::min(seen.nearest, now.distance - radius);
            before[i] = now;
        }
    }
    return seen;
}

struct Tally {
    int touching = 0, free = 0;
};

}  // namespace

TEST_CASE("nodes and edges that come to touch a collider are found, and no others", "[unit]") {
    Random random{17};
    for (const Named& shape : shapes)
        for (Kind kind : {Kind::node, Kind::edge}) {
            Tally tally;
            for (int trial = 0; trial < 150; ++trial) {
                const Index part = trial % collider_part_count(shape.geometry.shape);
                const Scene scene = random_scene(random, kind, part, inside(random, shape.geometry), trial % 3 == 0);
                const Real start = nearest_touch(shape.geometry, scene.feature, scene.at(0)).distance;
                const std::optional<Touch> touch = first_touch(shape.geometry, scene.motion, h, scene.feature);
                INFO(shape.name << ", trial " << trial << ", " << scene.feature.nodes() << " nodes");
                if (!(start > 0)) {
                    CHECK(!touch);
                    continue;
                }
                Real nearest = start;
                for (int t = 0; t <= times; ++t)
                    nearest = std::min(
                        nearest, sampled_distance(shape.geometry, part, scene.at(static_cast<Real>(t) / times), kind));
                if (nearest <= 0) REQUIRE(touch);
                // Samples may miss as much as the motion between two times and the distance between two places.
                const Real missed = greatest_approach(scene.motion, h, scene.feature) / times + 1.0 / places;
                const bool is_wall = shape.geometry.shape == ColliderShape::bucket && part == 1;
                if (nearest > (is_wall ? 4 : 1) * contact_slack * start + missed) CHECK(!touch);
                ++(touch ? tally.touching : tally.free);
                if (!touch) continue;
                CHECK(touch->distance > 0);
                CHECK(touch->distance <= (1 + 1e-9) * contact_slack * start);
                CHECK(touch->weight[0] + touch->weight[1] == Approx(1));
                CHECK(touch->normal.norm() == Approx(1));
            }
            CHECK(tally.touching > 10);
            CHECK(tally.free > 10);
        }
}

TEST_CASE("nodes that end a step behind a plane are found, and no others", "[unit]") {
    Random random{23};
    const ColliderGeometry plane{ColliderShape::plane, Vec3::Zero()};
    Tally tally;
    for (int trial = 0; trial < draws(300); ++trial) {
        const Scene scene = random_scene(random, Kind::node, 0, 0.2 * random.vector(), trial % 3 == 0);
        const Real start = scene.at(0)[0].z(), end = scene.at(1)[0].z();
        const std::optional<Touch> touch = first_touch(plane, scene.motion, h, scene.feature);
        INFO("trial " << trial << ", from " << start << " to " << end);
        REQUIRE(touch.has_value() == (start > 0 && end < 0));
        ++(touch ? tally.touching : tally.free);
        if (touch) CHECK(touch->normal.z() == Approx(1));
    }
    CHECK(tally.touching > draws(50));
    CHECK(tally.free > draws(50));
}

TEST_CASE("spheres that come to touch a collider are found before they do, and no others", "[unit]") {
    Random random{19};
    for (const Named& shape : shapes) {
        Tally tally;
        for (int trial = 0; trial < draws(800); ++trial) {
            const Index part = trial % collider_part_count(shape.geometry.shape);
            Scene scene = random_scene(random, Kind::node, part, inside(random, shape.geometry), trial % 3 == 0);
            const Real radius = 0.2 * std::abs(random.number()),
                       start = local_distance(shape.geometry, scene.at(0)[0], part).distance - radius;
            scene.feature.threshold = {radius, 1e-3};
            const std::optional<Touch> touch = first_touch(shape.geometry, scene.motion, h, scene.feature);
            INFO(shape.name << ", trial " << trial << ", radius " << radius);
            if (!(start > 0)) {
                CHECK(!touch);
                continue;
            }
            Real nearest = start;
            for (int t = 0; t <= times; ++t)
                nearest = std::min(
                    nearest,
                    local_distance(shape.geometry, scene.at(static_cast<Real>(t) / times)[0], part).distance - radius);
            if (nearest <= 0) REQUIRE(touch);
            if (nearest > 1e-3 + greatest_approach(scene.motion, h, scene.feature) / times) CHECK(!touch);
            ++(touch ? tally.touching : tally.free);
            if (!touch) continue;
            CHECK(touch->distance > 0);
            CHECK(touch->distance <= 1e-3);
        }
        CHECK(tally.touching > draws(40));
        CHECK(tally.free > draws(40));
    }
}

TEST_CASE("points, ends and rims of colliders that come to touch a face are found, and no others", "[unit]") {
    Random random{18};
    int free = 0;
    for (const Named& shape : shapes) {
        int touching = 0;
        for (int trial = 0; trial < draws(1000); ++trial) {
            Index k = trial % collider_point_count(shape.geometry.shape);
            const bool has_rims =
                shape.geometry.shape == ColliderShape::cylinder || shape.geometry.shape == ColliderShape::bucket;
            if (has_rims) k = k / 5 * 5;
            const Vec3 aim = collider_point(shape.geometry, k, random.vector()).at;
            const Scene scene = random_scene(random, Kind::face, k, aim, trial % 3 == 0);
            const Real start = nearest_touch(shape.geometry, scene.feature, scene.at(0)).distance;
            if (!(start > 0)) continue;
            const std::optional<Touch> touch = first_touch(shape.geometry, scene.motion, h, scene.feature);
            INFO(shape.name << ", trial " << trial);
            const Seen seen = look_at_face(shape.geometry, scene, contact_slack * start + 0.01);
            if (seen.enters) REQUIRE(touch);
            ++(touch ? touching : free);
            if (!touch) continue;
            CHECK(touch->distance > 0);
            CHECK(touch->distance <= (1 + 1e-9) * contact_slack * start);
            CHECK(touch->weight[0] + touch->weight[1] + touch->weight[2] == Approx(1));
            CHECK(touch->normal.norm() == Approx(1));
        }
        INFO(shape.name);
        CHECK(touching > draws(8));
    }
    CHECK(free > draws(200));
}

TEST_CASE("a face that slides very near along a ball for long is not given up as touching", "[unit]") {
    const ColliderGeometry ball{ColliderShape::sphere, {0.002, 0, 0}};
    const RigidMotion still{Vec3::Zero(), Mat3::Identity(), Vec3::Zero(), Vec3::Zero()};
    const Real above = 0.002 + 1e-9;
    TouchingFeature face{Kind::face, 0, {{{-2, -1, above}, {1, 2, above}, {1, -1, above}}}};
    for (Vec3& d : face.displacement) d = {0.5, 0, 0};
    CHECK(!first_touch(ball, still, h, face));
    for (Vec3& d : face.displacement) d = {0.5, 0, -2e-9};
    CHECK(first_touch(ball, still, h, face));
}

}  // namespace skerry::test::time_of_touch_test
