// Overlapping solids: detected, told apart from touching ones, and separated along the reported direction.
#include <catch2/catch.hpp>
#include <limits>

#include "systems/collision/build_surface.h"
#include "systems/collision/overlap/collider_overlap.h"
#include "systems/collision/overlap/solid_overlap.h"
#include "tests/support/draws.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/surfaces_cross.h"

namespace skerry::test::overlap_test {

namespace {

constexpr Real tolerance = 1e-9;

Solid solid_of(const SolidMesh& mesh, const Mat3& rotation = Mat3::Identity()) {
    std::vector<Vec3> point = mesh.nodes;
    for (Vec3& x : point) x = rotation * x;
    std::vector<SolidTriangle> surface;
    for (const BoundaryTriangle& t : boundary_triangles(mesh.tetrahedra)) surface.push_back({t.node, t.element});
    return solid_of_tetrahedra(point, mesh.tetrahedra, std::move(surface));
}

/// The boundary as a surface; `inwards` orients it as seen from inside, like that of a room.
Solid surface_of(const SolidMesh& mesh, bool inwards = false) {
    std::vector<std::array<Index, 3>> triangles;
    for (const BoundaryTriangle& t : boundary_triangles(mesh.tetrahedra)) {
        triangles.push_back(t.node);
        if (inwards) std::swap(triangles.back()[0], triangles.back()[1]);
    }
    return solid_of_surface(mesh.nodes, triangles);
}

std::optional<Overlap> overlap_at(const Solid& first, const Solid& second, const Vec3& shift) {
    return find_overlap({first, shift}, {second, Vec3::Zero()}, tolerance);
}

SolidMesh one_tetrahedron(Random& random) {
    SolidMesh mesh{{random.vector(), random.vector(), random.vector(), random.vector()}, {{0, 1, 2, 3}}};
    const Vec3& a = mesh.nodes[0];
    if ((mesh.nodes[1] - a).cross(mesh.nodes[2] - a).dot(mesh.nodes[3] - a) < 0)
        std::swap(mesh.nodes[2], mesh.nodes[3]);
    return mesh;
}

std::vector<std::array<Index, 3>> triangles_of(const Solid& solid) {
    std::vector<std::array<Index, 3>> triangles;
    for (const SolidTriangle& t : solid.surface) triangles.push_back(t.node);
    return triangles;
}

/// Reference without a tree and separating axes: surfaces that cross, or a corner of one solid in the other.
bool overlap_by_force(const Solid& first, const Solid& second, const Vec3& shift) {
    std::vector<Vec3> moved = first.point;
    for (Vec3& x : moved) x += shift;
    const auto own = triangles_of(first), other = triangles_of(second);
    if (crossings({moved, own}, {second.point, other}) > 0) return true;
    const auto inside = [](std::span<const Vec3> x, const Solid& solid, std::span<const Vec3> corners) {
        for (const Vec3& p : x)
            for (const auto& t : solid.simplex) {
                const auto at = [&](std::size_t k) { return corners[static_cast<std::size_t>(t[k])]; };
                if (orientation(at(0), at(1), at(2), p) > 0 && orientation(at(0), at(3), at(1), p) > 0 &&
                    orientation(at(0), at(2), at(3), p) > 0 && orientation(at(1), at(3), at(2), p) > 0)
                    return true;
            }
        return false;
    };
    return inside(moved, second, second.point) || inside(second.point, first, moved);
}

}  // namespace

TEST_CASE("tetrahedra overlap as every edge, face and corner says, and are apart where the way out ends", "[unit]") {
    Random random(1);
    int overlapping = 0;
    for (int i = 0; i < draws(3000); ++i) {
        const Solid a = solid_of(one_tetrahedron(random)), b = solid_of(one_tetrahedron(random));
        const Vec3 shift = random.vector();
        const SimplexOverlap overlap(a.at(0).moved(shift), b.at(0), 0);
        REQUIRE(overlap.overlapping() == overlap_by_force(a, b, shift));
        if (!overlap.overlapping()) continue;
        ++overlapping;
        const Vec3 direction = random.vector().normalized();
        const Real way = overlap.exit_distance(direction);
        CHECK(SimplexOverlap(a.at(0).moved(shift + (way - 1e-6) * direction), b.at(0), 0).overlapping());
        CHECK_FALSE(SimplexOverlap(a.at(0).moved(shift + (way + 1e-6) * direction), b.at(0), 0).overlapping());
    }
    CHECK(overlapping > draws(500));
}

TEST_CASE("a triangle overlaps a tetrahedron that it goes through, and none that it lies on", "[unit]") {
    const Simplex tetrahedron{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}, 4};
    const auto at = [](Real z) { return Simplex{{Vec3(-5, -5, z), Vec3(9, -5, z), Vec3(0, 9, z), Vec3::Zero()}, 3}; };
    CHECK_FALSE(SimplexOverlap(tetrahedron, at(0), tolerance).overlapping());
    CHECK_FALSE(SimplexOverlap(tetrahedron, at(1), tolerance).overlapping());
    CHECK_FALSE(SimplexOverlap(tetrahedron, at(-0.1), tolerance).overlapping());
    const SimplexOverlap through(tetrahedron, at(0.25), tolerance);
    REQUIRE(through.overlapping());
    CHECK(through.exit_distance(Vec3::UnitZ()) == Approx(0.25));
    CHECK(through.exit_distance(-Vec3::UnitZ()) == Approx(0.75));
}

TEST_CASE("boxes that share a face, an edge or a corner only touch, wherever they are", "[unit]") {
    for (Index cells : {1, 2, 3})
        for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.7), Vec3(33.3, -71.7, 12.9)}) {
            SolidMesh mesh = box_mesh({cells, cells, cells}, Vec3(0.1, 0.3, 0.7));
            const Solid second = solid_of(mesh);
            for (const Vec3& side : {Vec3(1, 0, 0), Vec3(0, 1, 1), Vec3(1, 1, -1), Vec3(0, 0, 1)}) {
                const Vec3 shift = side.cwiseProduct(Vec3(0.1, 0.3, 0.7));
                CHECK_FALSE(find_overlap({second, origin + shift}, {second, origin}, tolerance));
                CHECK_FALSE(find_overlap({second, origin + 1.001 * shift}, {second, origin}, tolerance));
                const auto overlap = find_overlap({second, origin + 0.999 * shift}, {second, origin}, tolerance);
                INFO("cells " << cells << ", origin " << origin.transpose() << ", side " << side.transpose());
                REQUIRE(overlap);
                CHECK(overlap->kind == OverlapKind::crossing);
            }
        }
}

TEST_CASE("boxes in a row, whose faces lie in the same planes, overlap by the missing distance", "[unit]") {
    for (Index cells : {1, 2, 5}) {
        const Solid box = solid_of(box_mesh({cells, cells, cells}, Vec3(1, 1, 1)));
        for (int axis = 0; axis < 3; ++axis) {
            const auto overlap = overlap_at(box, box, 0.99 * Vec3::Unit(axis));
            REQUIRE(overlap);
            CHECK(overlap->kind == OverlapKind::crossing);
            CHECK(overlap->depth == Approx(0.01));
            CHECK(overlap->direction.dot(Vec3::Unit(axis)) == Approx(1));
            CHECK(overlap->place.dot(Vec3::Unit(axis)) == Approx(0.495));
        }
    }
}

TEST_CASE("balls overlap by their depth along the line of their centres", "[unit]") {
    const Solid ball = solid_of(ball_mesh(0.1, 4));
    for (const Vec3& towards : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0)})
        for (Real depth : {1e-4, 5e-4, 5e-3, 0.02, 0.06}) {
            const auto overlap = overlap_at(ball, ball, (0.2 - depth) * towards);
            INFO("towards " << towards.transpose() << ", depth " << depth);
            REQUIRE(overlap);
            CHECK(overlap->kind == OverlapKind::crossing);
            CHECK(overlap->depth == Approx(depth).epsilon(0.03));
            CHECK(overlap->direction.dot(towards) > 0.99);
        }
}

TEST_CASE("coincident, inner and enclosing solids are reported as overlaps", "[unit]") {
    for (Index cells : {1, 4}) {
        const Solid large = solid_of(box_mesh({cells, cells, cells}, Vec3(1, 1, 1))),
                    small = solid_of(box_mesh({cells, cells, cells}, Vec3(0.2, 0.2, 0.2)));
        REQUIRE(overlap_at(large, large, Vec3::Zero()));
        CHECK(overlap_at(large, large, Vec3::Zero())->kind == OverlapKind::coincident);
        const auto inside = overlap_at(small, large, Vec3(0.1, 0, 0.2));
        REQUIRE(inside);
        CHECK(inside->kind == OverlapKind::inside);
        CHECK(inside->depth == Approx(0.4));  // along z
        const auto around = overlap_at(large, small, Vec3(0.1, 0, 0.2));
        REQUIRE(around);
        CHECK(around->kind == OverlapKind::around);
    }
    const Solid outer = solid_of(ball_mesh(0.1, 4)), inner = solid_of(ball_mesh(0.03, 4));
    CHECK(overlap_at(inner, outer, Vec3::Zero())->kind == OverlapKind::inside);
    CHECK(overlap_at(outer, outer, Vec3::Zero())->kind == OverlapKind::coincident);
}

TEST_CASE("bars that go through each other between their nodes overlap", "[unit]") {
    const Solid along = solid_of(box_mesh({1, 1, 1}, Vec3(4, 0.2, 0.2))),
                across = solid_of(box_mesh({1, 1, 1}, Vec3(0.2, 4, 0.2)));
    const auto overlap = overlap_at(along, across, Vec3(0.03, 0.07, 0.15));
    REQUIRE(overlap);
    CHECK(overlap->depth == Approx(0.05));
    CHECK(overlap->direction.z() == Approx(1));
    CHECK_FALSE(overlap_at(along, across, Vec3(0.03, 0.07, 0.2)));
}

TEST_CASE("a closed surface has an inside, a room seen from inside and an open surface have none", "[unit]") {
    const SolidMesh room = box_mesh({3, 3, 3}, Vec3(1, 1, 1));
    const Solid ball = solid_of(ball_mesh(0.05, 4));
    const auto inside = overlap_at(ball, surface_of(room), Vec3(0, 0, 0.2));
    REQUIRE(inside);
    CHECK(inside->kind == OverlapKind::inside);
    CHECK(inside->depth == Approx(0.35));
    CHECK_FALSE(overlap_at(ball, surface_of(room, true), Vec3(0, 0, 0.2)));
    CHECK(overlap_at(ball, surface_of(room, true), Vec3(0, 0, 0.48)));  // through its wall
    CHECK_FALSE(overlap_at(ball, surface_of(room), Vec3(0, 0, 0.56)));

    const std::vector<Vec3> corner{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const Solid sheet = solid_of_surface(corner, std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 2, 3}});
    CHECK_FALSE(sheet.closed);
    CHECK_FALSE(overlap_at(ball, sheet, Vec3(0, 0, 0.05)));
    CHECK_FALSE(overlap_at(ball, sheet, Vec3(0, 0, -0.06)));
    for (Real side : {1.0, -1.0}) {
        const auto through = overlap_at(ball, sheet, Vec3(0.1, 0, 0.04 * side));
        REQUIRE(through);
        CHECK(through->depth == Approx(0.01));
        CHECK(through->direction.z() == Approx(side));
    }
}

TEST_CASE("points are inside of a surface as they are inside of its tetrahedra, on its grid lines, too", "[unit]") {
    const SolidMesh mesh = box_mesh({4, 4, 4}, Vec3(1, 1, 1));
    const Solid surface = surface_of(mesh);
    for (Real x : {-0.75, -0.25, 0.0, 0.125, 0.25, 0.6})
        for (Real y : {-0.75, -0.25, 0.0, 0.125, 0.25, 0.6})
            for (Real z : {-0.75, -0.25, 0.0, 0.2, 0.75})
                CHECK(contains(surface, {x, y, z}, 0) == (Vec3(x, y, z).cwiseAbs().maxCoeff() < 0.5));
    Random random(2);
    const SolidMesh ball = ball_mesh(1, 4);
    const Solid tetrahedra = solid_of(ball), shell = surface_of(ball);
    for (int i = 0; i < draws(2000); ++i) {
        const Vec3 x = 1.2 * random.vector();
        CHECK(contains(shell, x, 0) == contains(tetrahedra, x, 0));
    }
}

TEST_CASE("random solids overlap if and only if every edge, face and node by itself says so", "[unit]") {
    Random random(3);
    int overlapping = 0, apart = 0;
    for (int i = 0; i < draws(1000); ++i) {
        const auto any = [&] {
            const Mat3 turn = random.rotation();
            if (random.number() > 0) return solid_of(ball_mesh(0.5 + 0.2 * random.number(), 2), turn);
            return solid_of(box_mesh({2, 1, 2}, Vec3(0.6, 0.6, 0.6) + 0.5 * random.vector()), turn);
        };
        const Solid first = any(), second = any();
        const Vec3 shift = random.vector();
        const auto overlap = overlap_at(first, second, shift);
        INFO("pair " << i);
        REQUIRE(overlap.has_value() == overlap_by_force(first, second, shift));
        if (!overlap) {
            ++apart;
            continue;
        }
        ++overlapping;
        CHECK_FALSE(overlap_at(first, second, shift + (overlap->depth + 1e-7) * overlap->direction));
        if (overlap->kind == OverlapKind::crossing) CHECK(overlap->depth < 2);
    }
    CHECK(overlapping > draws(250));
    CHECK(apart > draws(250));
}

TEST_CASE("a box in every collider is found, outside by nothing it is not", "[unit]") {
    const Solid box = solid_of(box_mesh({2, 2, 2}, Vec3(0.2, 0.2, 0.2)));
    const RigidMotion still{Vec3(1, 2, 3), Mat3::Identity(), Vec3::Zero(), Vec3::Zero()};
    struct Case {
        ColliderGeometry geometry;
        Real touching;  // height of the box above the origin of the shape at which they touch [m]
    };
    const std::vector<Case> cases{
        {{ColliderShape::plane, Vec3::Zero()}, 0.1},         {{ColliderShape::sphere, Vec3(0.5, 0, 0)}, 0.6},
        {{ColliderShape::box, Vec3(0.5, 0.4, 0.3)}, 0.4},    {{ColliderShape::capsule, Vec3(0.2, 0.4, 0)}, 0.7},
        {{ColliderShape::cylinder, Vec3(0.5, 0.3, 0)}, 0.4}, {{ColliderShape::bucket, Vec3(0.5, 0.6, 0.05)}, 0.1},
    };
    for (const Case& c : cases) {
        const auto at = [&](Real z) {
            return find_surface_inside(c.geometry, still, {box, still.position + Vec3(0, 0, z)}, tolerance);
        };
        INFO("shape " << static_cast<int>(c.geometry.shape));
        CHECK_FALSE(at(c.touching));
        CHECK_FALSE(at(c.touching + 1e-3));
        const auto shallow = at(c.touching - 1e-3);
        REQUIRE(shallow);
        CHECK(shallow->kind == OverlapKind::crossing);
        CHECK(shallow->depth == Approx(1e-3));
        CHECK(shallow->direction.z() == Approx(1));
    }
    const auto buried = find_surface_inside(cases[2].geometry, still, {box, still.position}, tolerance);
    REQUIRE(buried);
    CHECK(buried->kind == OverlapKind::inside);
    const Solid large = solid_of(box_mesh({2, 2, 2}, Vec3(9, 9, 9)));
    for (std::size_t k = 1; k < cases.size(); ++k) {
        CHECK_FALSE(find_surface_inside(cases[k].geometry, still, {large, still.position + Vec3(1, 2, 1)}, tolerance));
        const auto around =
            find_collider_inside(cases[k].geometry, still, {large, still.position + Vec3(1, 2, 1)}, tolerance);
        REQUIRE(around);
        CHECK(around->kind == OverlapKind::around);
        CHECK_FALSE(find_collider_inside(cases[k].geometry, still, {large, still.position + Vec3(0, 0, 6)}, tolerance));
    }
}

TEST_CASE("a tree over boxes finds all overlapping boxes, and none that is not finite", "[unit]") {
    Random random(4);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 500; ++i) {
        const Vec3 at = random.vector();
        boxes.push_back({at, at + Vec3::Constant(0.1)});
    }
    boxes[7].upper[1] = std::numeric_limits<Real>::quiet_NaN();
    const BoxTree tree(boxes);
    for (int i = 0; i < 50; ++i) {
        const Vec3 at = random.vector();
        const Aabb wanted{at, at + Vec3::Constant(0.3)};
        std::vector<Index> found, expected;
        tree.for_each_overlap(wanted, [&](Index item) { found.push_back(item); });
        for (std::size_t b = 0; b < boxes.size(); ++b)
            if (boxes_overlap(boxes[b], wanted)) expected.push_back(static_cast<Index>(b));
        std::ranges::sort(found);
        CHECK(found == expected);
    }
    int visits = 0;
    BoxTree().for_each_overlap(boxes[0], [&](Index) { ++visits; });
    CHECK(visits == 0);
}

}  // namespace skerry::test::overlap_test
