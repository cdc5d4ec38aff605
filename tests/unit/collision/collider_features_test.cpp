// Edges and faces of bodies against colliders: contacts between the nodes, compared with dense sampling.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/colliders/edge_contact.h"
#include "tests/support/draws.h"
#include "tests/support/random.h"

namespace skerry::test::collider_features_test {

namespace {

struct Named {
    const char* name;
    ColliderGeometry geometry;
};

const Named shapes[] = {
    {"sphere", {ColliderShape::sphere, {0.6, 0, 0}}},     {"box", {ColliderShape::box, {0.3, 0.5, 0.8}}},
    {"capsule", {ColliderShape::capsule, {0.3, 0.4, 0}}}, {"cylinder", {ColliderShape::cylinder, {0.5, 0.4, 0}}},
    {"bucket", {ColliderShape::bucket, {0.5, 0.6, 0.1}}}, {"thick bucket", {ColliderShape::bucket, {0.3, 0.3, 0.4}}},
    {"thin box", {ColliderShape::box, {0.7, 0.01, 0.4}}}, {"flat cylinder", {ColliderShape::cylinder, {0.7, 0.05, 0}}},
};

constexpr int samples = 400;

struct Sampled {
    Real least = std::numeric_limits<Real>::infinity();  // [m]
    Real at_ends = 0;                                    // [m]
};

Sampled sample_edge(const ColliderGeometry& geometry, Index part, const Vec3& a, const Vec3& b) {
    Sampled sampled;
    for (int i = 0; i <= samples; ++i) {
        const Real s = static_cast<Real>(i) / samples;
        sampled.least = std::min(sampled.least, local_distance(geometry, a + s * (b - a), part).distance);
    }
    sampled.at_ends = std::min(local_distance(geometry, a, part).distance, local_distance(geometry, b, part).distance);
    return sampled;
}

Real sample_face(const ColliderGeometry& geometry, const LocalFace& face) {
    constexpr int cuts = 40;
    Real least = std::numeric_limits<Real>::infinity();
    for (int i = 0; i <= cuts; ++i)
        for (int j = 0; i + j <= cuts; ++j) {
            const Real u = static_cast<Real>(i) / cuts, v = static_cast<Real>(j) / cuts;
            const Vec3 point = (1 - u - v) * face[0] + u * face[1] + v * face[2];
            least = std::min(least, local_distance(geometry, point).distance);
        }
    return least;
}

}  // namespace

TEST_CASE("the points of an edge that touch have the least distance that any of its points has", "[unit]") {
    test::Random random{7};
    for (const Named& shape : shapes) {
        INFO(shape.name);
        int between = 0;
        for (int trial = 0; trial < draws(4000); ++trial) {
            const Vec3 a = 1.2 * random.vector(), b = a + 0.4 * random.vector();
            for (Index part = 0; part < collider_part_count(shape.geometry.shape); ++part) {
                const Sampled sampled = sample_edge(shape.geometry, part, a, b);
                const EdgeContact contact = edge_contact(shape.geometry, part, a, b);
                const Real length = (b - a).norm();
                CHECK(contact.nearest <= sampled.least + 1e-12);
                CHECK(contact.nearest >= edge_distance(shape.geometry, part, a, b));
                const bool is_wall = shape.geometry.shape == ColliderShape::bucket && part == 1;
                // Between samples the distance is lower by at most half of their spacing.
                if (!is_wall) CHECK(contact.nearest >= sampled.least - (2e-4 + 0.5 / samples) * length);
                Real least = sampled.at_ends;
                for (std::size_t i = 0; i < contact.count; ++i) {
                    const EdgePoint& point = contact.point[i];
                    CHECK(point.s > 0);
                    CHECK(point.s < 1);
                    CHECK(point.on.distance ==
                          Approx(local_distance(shape.geometry, a + point.s * (b - a), part).distance).margin(1e-12));
                    CHECK(point.on.normal.norm() == Approx(1));
                    // Halfway through the thinnest shape two ways out are equally short.
                    const bool least_there = point.number % 4 < 2;
                    if (point.on.distance > -0.005 && least_there)
                        CHECK(std::abs(point.on.normal.dot(b - a)) <= 2e-3 * length);
                    // The other points are where the edge begins to rise by 0.05. Seen from outside, a convex shape has
                    // no kinks.
                    if (!least_there && !is_wall && point.on.distance > 0)
                        CHECK(std::abs(point.on.normal.dot(b - a)) / length == Approx(0.05).margin(1e-5));
                    least = std::min(least, point.on.distance);
                    ++between;
                }
                // Minima that are left out are flatter than a hundredth of the default contact distance over the edge.
                // Minima of a non-convex wall may be missed from far away.
                if (sampled.least < 0.2) CHECK(least <= sampled.least + 2e-4 * length);
            }
        }
        CHECK(between > draws(50));
    }
}

TEST_CASE("an edge that lies along a side and reaches beyond it is held where it leaves the side", "[unit]") {
    const ColliderGeometry box{ColliderShape::box, {0.5, 0.5, 0.5}};
    struct Case {
        Real rise;  // height of the end beyond the box above the end over its face [m]
        Index number;
    };
    for (const Case& c : {Case{0, 1}, Case{0.01, 3}}) {
        INFO(c.rise);
        const EdgeContact contact = edge_contact(box, 0, {0, 0, 0.51}, {1, 0, 0.51 + c.rise});
        REQUIRE(contact.count == 1);
        CHECK(contact.point[0].number == c.number);
        // The point is where the edge has risen by the slope that counts, just beyond the corner.
        CHECK(contact.point[0].s > 0.499);
        CHECK(contact.point[0].s < 0.502);
        CHECK(contact.point[0].on.normal[2] > 0.99);
    }
    CHECK(edge_contact(box, 0, {0, 0, 0.51}, {1, 0, 0.71}).count == 0);  // it rises by a larger slope from the start
    CHECK(edge_contact(box, 0, {-0.4, 0, 0.51}, {0.4, 0, 0.51}).count == 0);

    // The edge spans the face: both ends of the stretch above it are found.
    const EdgeContact across = edge_contact(box, 0, {-1, 0, 0.51}, {1, 0, 0.51});
    REQUIRE(across.count == 2);
    CHECK(across.point[0].s == Approx(0.25).margin(1e-3));
    CHECK(across.point[1].s == Approx(0.75).margin(1e-3));
}

TEST_CASE("where a collider is flat no place of a segment or triangle is nearer than its corners", "[unit]") {
    test::Random random{11};
    for (const Named& shape : shapes) {
        INFO(shape.name);
        std::size_t flat = 0;
        for (int trial = 0; trial < draws(20000); ++trial) {
            const Vec3 middle = 0.9 * random.vector();
            const LocalFace face{middle + 0.2 * random.vector(), middle + 0.2 * random.vector(),
                                 middle + 0.2 * random.vector()};
            const Real reach = flat_reach(shape.geometry, face);
            if (!(reach >= 0)) continue;
            ++flat;
            Real corners = std::numeric_limits<Real>::infinity();
            for (const Vec3& p : face) corners = std::min(corners, local_distance(shape.geometry, p).distance);
            // Deep in the corner of a bucket the floor and the wall are one solid, and neither is the nearest.
            if (corners > -0.02) CHECK(sample_face(shape.geometry, face) >= corners - 1e-12);

            // The face stays flat while no corner moves further than the reach.
            LocalFace moved = face;
            for (Vec3& p : moved) p += 0.999 * reach * random.vector().normalized();
            CHECK(flat_reach(shape.geometry, moved) >= 0);
        }
        const bool round =
            shape.geometry.shape == ColliderShape::sphere || shape.geometry.shape == ColliderShape::capsule;
        CHECK((flat == 0) == round);
    }
    const ColliderGeometry plane{ColliderShape::plane, Vec3::Zero()};
    CHECK(flat_reach(plane, LocalFace{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitZ()}) ==
          std::numeric_limits<Real>::infinity());
}

TEST_CASE("the distance of a hull is a bound of that of each of its places", "[unit]") {
    test::Random random{13};
    for (const Named& shape : shapes) {
        INFO(shape.name);
        Real tightest = std::numeric_limits<Real>::infinity();
        for (int trial = 0; trial < draws(2000); ++trial) {
            const Vec3 middle = 1.5 * random.vector();
            const LocalFace face{middle + 0.3 * random.vector(), middle + 0.3 * random.vector(),
                                 middle + 0.3 * random.vector()};
            const Real bound = hull_distance(shape.geometry, face), least = sample_face(shape.geometry, face);
            CHECK(bound <= least + 1e-12);
            tightest = std::min(tightest, least - bound);
        }
        CHECK(tightest < 1e-3);
    }
}

TEST_CASE("a face meets the deepest point of a collider behind it, or an edge or node of it does", "[unit]") {
    test::Random random{17};
    for (const Named& shape : shapes) {
        INFO(shape.name);
        if (shape.geometry.shape == ColliderShape::bucket)
            continue;  // not convex: the minimum may be inside its hollow
        int faces = 0;
        for (int trial = 0; trial < draws(3000); ++trial) {
            const Vec3 middle = 1.5 * random.vector();
            const LocalFace face{middle + 0.5 * random.vector(), middle + 0.5 * random.vector(),
                                 middle + 0.5 * random.vector()};
            const Real truth = sample_face(shape.geometry, face);
            if (truth < 0.01) continue;  // overlap follows other rules
            Real found = std::numeric_limits<Real>::infinity(), of_faces = found;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 &a = face[k], &b = face[(k + 1) % 3];
                found = std::min(found, local_distance(shape.geometry, a).distance);
                const EdgeContact edge = edge_contact(shape.geometry, 0, a, b);
                for (std::size_t i = 0; i < edge.count; ++i) found = std::min(found, edge.point[i].on.distance);
            }
            for (Index k = 0; k < collider_point_count(shape.geometry.shape); ++k) {
                // The face is oriented so that the collider is outside.
                const FaceContact up = face_contact(shape.geometry, k, face);
                const FaceContact contact = up.normal.dot(up.point.at - face[0]) >= 0
                                                ? up
                                                : face_contact(shape.geometry, k, {face[0], face[2], face[1]});

                if (contact.above && contact.distance > 0) of_faces = std::min(of_faces, contact.distance);
            }
            faces += of_faces < found;
            CHECK(std::min(found, of_faces) <= truth + 1e-3);
            CHECK(std::min(found, of_faces) >= truth - 2e-2);
        }
        CHECK(faces > draws(20));
    }
}

}  // namespace skerry::test::collider_features_test
