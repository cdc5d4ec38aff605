// Visual surfaces: reading, binding to bodies, and their fate in worlds and files.
#include "skerry/visual.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <utility>

#include "engine/mesh/visual/bound_visual.h"
#include "engine/output/collect_frame.h"
#include "engine/output/page/stream/visual_stream.h"
#include "engine/output/vtk/vtk_series.h"
#include "page_stream_reader.h"
#include "scene_files.h"
#include "skerry/error.h"
#include "skerry/scene.h"
#include "systems/geometry/rotation.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::visual_test {

using Catch::Matchers::Contains;

namespace {

/// A fine ball around and inside of a coarse box of edge length 1.
VisualSurface fine_ball(Real radius = 0.6) {
    const SurfaceMesh ball = mesh::boundary(mesh::ball(radius, 12));
    return {.nodes = ball.nodes, .triangles = ball.triangles};
}

Mesh coarse_box() {
    return mesh::box({1, 1, 1}, {3, 3, 3});
}

Real largest_error(std::span<const Vec3> found, std::span<const Vec3> expected) {
    Real most = found.size() == expected.size() ? 0 : infinity;
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
        most = std::max(most, (found[i] - expected[i]).norm());
    return most;
}

std::vector<Vec3> moved(std::span<const Vec3> points, auto&& motion) {
    std::vector<Vec3> out;
    for (const Vec3& point : points) out.push_back(motion(point));
    return out;
}

/// A motion that is not affine, so that deformation gradients differ between tetrahedra.
Vec3 bent(const Vec3& x) {
    return x + 0.2 * Vec3(std::sin(3 * x.y() + 4 * x.x()), std::sin(4 * x.z() + 5 * x.y()),
                          std::sin(5 * x.x() + 3 * x.z()));
}

/// Largest distance between consecutive points of a path around a box, after the box was bent.
Real longest_step(std::size_t count) {
    const Mesh box = coarse_box();
    VisualSurface path{.triangles = {{0, 1, 2}}};
    for (std::size_t i = 0; i < count; ++i) {
        const Real t = 2 * 3.14159265358979 * static_cast<Real>(i) / static_cast<Real>(count);
        // It crosses tetrahedra, faces and edges, inside of the box and up to 0.4 m outside.
        path.nodes.emplace_back(0.9 * std::cos(t), 0.55 * std::sin(t), 0.5 * std::sin(3 * t));
    }
    const BoundVisual bound = bind_visual(path, box.nodes, box.tetrahedra);
    const std::vector<Vec3> after = visual_positions(bound, moved(box.nodes, bent));
    Real longest = 0;
    for (std::size_t i = 0; i + 1 < count; ++i) longest = std::max(longest, (after[i + 1] - after[i]).norm());
    return longest;
}

}  // namespace

TEST_CASE("an .obj file gives texture coordinates and the materials of its .mtl file", "[unit][visual]") {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "square.obj").string();
    std::ofstream(file) << "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.5 1\n"
                           "f 1 2 3\nusemtl dark red\nf 1/1 2/2 3/3 4/-1\n";
    std::ofstream(folder.path() / "square.mtl")
        << "newmtl other\nKd 1 1 1\nnewmtl dark red\nKd 0.5 0.1 0\nd 0.25\nTr 1\n"
           "map_Kd -s 1 1 1 skin.png\n";
    std::vector<std::string> notes;
    const VisualSurface square = mesh::read_visual(file, &notes);
    CHECK(notes.empty());
    using Corners = std::vector<std::array<Index, 3>>;
    CHECK(square.triangles == Corners{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}});
    CHECK(square.texture_corners == Corners{{-1, -1, -1}, {0, 1, 2}, {0, 2, 2}});
    CHECK(square.material == std::vector<Index>{no_index, 0, 0});
    REQUIRE(square.materials.size() == 1);
    CHECK(square.materials[0] ==
          VisualMaterial{"dark red", {0.5, 0.1, 0}, 0.25, (folder.path() / "skin.png").string()});
    // Points at a seam: node 2 has one point with texture and one without.
    CHECK(split_at_seams(square).node == std::vector<Index>{0, 1, 2, 0, 1, 2, 3});

    std::filesystem::remove(folder.path() / "square.mtl");
    CHECK(mesh::read_visual(file, &notes).materials[0].color == VisualMaterial{}.color);
    REQUIRE(notes.size() == 2);
    CHECK_THAT(notes[0], Contains("the material file \"square.mtl\" does not exist"));
    CHECK_THAT(notes[1], Contains("no material file defines the material \"dark red\""));
    std::ofstream(file, std::ios::app) << "f 1/1 2/2 3/4\n";
    CHECK_THROWS_WITH(mesh::read_visual(file), Contains("line 12: texture point: found 4, expected 1 to 3"));
}

TEST_CASE("a visual surface follows affine motions exactly, inside and outside of its body", "[unit][visual]") {
    Mat3 F;
    F << 1.3, 0.2, -0.1, 0.4, 0.8, 0.3, -0.2, 0.1, 1.1;
    const auto affine = [&](const Vec3& x) -> Vec3 { return F * x + Vec3(0.3, -0.2, 0.5); };
    const Mesh box = coarse_box();
    const BoundVisual bound = bind_visual(fine_ball(), box.nodes, box.tetrahedra);
    CHECK(bound.fit.outside > 100);
    CHECK(bound.fit.outside < bound.surface.nodes.size());
    CHECK(bound.fit.farthest == Approx(0.1));
    CHECK(bound.fit.warning.empty());
    // rounding of sums of a few dozen numbers of about 1
    CHECK(largest_error(visual_positions(bound, moved(box.nodes, affine)), moved(bound.surface.nodes, affine)) < 1e-14);

    // A rigid body without tetrahedra has only the nodes of its surface.
    const std::vector<Vec3> corners = mesh::boundary(box).nodes;
    const BoundVisual solid = bind_visual(fine_ball(), corners, {});
    CHECK(largest_error(visual_positions(solid, moved(corners, affine)), moved(solid.surface.nodes, affine)) < 1e-14);
}

TEST_CASE("a visual surface stays connected where its body deforms unevenly", "[unit][visual]") {
    // A jump between two tetrahedra or faces would have the same length on a finer path.
    const Real coarse = longest_step(4000), fine = longest_step(40000);
    CHECK(fine < 0.11 * coarse);
}

TEST_CASE("a visual surface beside a gap of its body follows the side that faces the same way", "[unit][visual]") {
    // Two blocks with a gap of 0.2 m. The visual square of the first block is 0.12 m in front of it.
    Mesh blocks = mesh::box({0.4, 0.4, 0.4}, {2, 2, 2});
    const auto count = static_cast<Index>(blocks.nodes.size());
    const Mesh one = blocks;
    for (const Vec3& node : one.nodes) blocks.nodes.push_back(node + Vec3(0.6, 0, 0));
    for (const auto& [a, b, c, d] : one.tetrahedra)
        blocks.tetrahedra.push_back({a + count, b + count, c + count, d + count});
    const VisualSurface square{.nodes = {{0.32, -0.1, -0.1}, {0.32, 0.1, -0.1}, {0.32, 0.1, 0.1}, {0.32, -0.1, 0.1}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}}};
    const auto second_away = [](const Vec3& x) -> Vec3 { return x.x() > 0.3 ? Vec3(x + Vec3(0.5, 0, 0)) : x; };
    const BoundVisual bound = bind_visual(square, blocks.nodes, blocks.tetrahedra);
    CHECK(largest_error(visual_positions(bound, moved(blocks.nodes, second_away)), square.nodes) < 1e-14);
    // The turned square belongs to the second block.
    VisualSurface turned = square;
    for (auto& triangle : turned.triangles) std::swap(triangle[0], triangle[1]);
    const BoundVisual behind = bind_visual(turned, blocks.nodes, blocks.tetrahedra);
    CHECK(visual_positions(behind, moved(blocks.nodes, second_away))[0].x() == Approx(0.82));
}

TEST_CASE("values of nodes are interpolated inside, and taken from the nearest point outside", "[unit][visual]") {
    const Mesh box = coarse_box();
    const VisualSurface surface{.nodes = {{0.1, 0.2, 0.05}, {0.3, 0.1, 0.8}, {0, 0, 0}}, .triangles = {{0, 1, 2}}};
    const BoundVisual bound = bind_visual(surface, box.nodes, box.tetrahedra);
    std::vector<Real> of_body;
    for (const Vec3& x : box.nodes) of_body.push_back(3 * x.x() - x.y() + 2 * x.z());
    const std::vector<Real> values = visual_values<Real>(bound, of_body);
    CHECK(values[0] == Approx(0.2));
    CHECK(values[1] == Approx(0.9 - 0.1 + 1));  // at z = 0.5
}

TEST_CASE("values on a rigid body without tetrahedra are those of the nearest point of its surface", "[unit][visual]") {
    const SurfaceMesh box = mesh::boundary(coarse_box());
    const BoundVisual bound = bind_visual(fine_ball(), box.nodes, {}, box.triangles);
    std::vector<Real> of_body;
    for (const Vec3& x : box.nodes) of_body.push_back(x.z() < -0.4 ? 1 : 0);
    const std::vector<Real> values = visual_values<Real>(bound, of_body);
    CHECK(std::ranges::min(values) > -1e-12);
    CHECK(std::ranges::max(values) < 1 + 1e-12);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (bound.surface.nodes[i].z() < -0.5) CHECK(values[i] == Approx(1));
    const Mat3 turn = Eigen::AngleAxis<Real>(2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const auto motion = [&](const Vec3& x) -> Vec3 { return turn * x + Vec3(0.3, -0.2, 0.5); };
    CHECK(largest_error(visual_positions(bound, moved(box.nodes, motion)), moved(bound.surface.nodes, motion)) < 1e-14);
}

TEST_CASE("a surface in other units, or far from its body, is reported", "[unit][visual]") {
    const Mesh box = coarse_box();
    const auto warning = [&](VisualSurface surface) {
        return bind_visual(std::move(surface), box.nodes, box.tetrahedra).fit.warning;
    };
    CHECK_THAT(warning(fine_ball(600)), Contains("1200 times as large as the body; check the units"));
    VisualSurface away = fine_ball();
    for (Vec3& node : away.nodes) node.x() += 4;
    CHECK_THAT(warning(away), Contains("up to 4.1 m outside of the body"));
}

TEST_CASE("a visual surface lives and moves with its body, and changes no step", "[unit][visual]") {
    World world{Settings{}}, plain{Settings{}};
    std::vector<BodyHandle> bodies;
    for (World* tested : {&plain, &world}) {
        const auto material = tested->add_material({});
        bodies = {tested->add_body(coarse_box(), {.material = material, .dynamics = BodyDynamics::explicit_elastic}),
                  tested->add_body(Sphere{0.5}, {.material = material, .position = {5, 0, 0}}),
                  tested->add_body(mesh::boundary(coarse_box()), {.material = material,
                                                                  .position = {0, 5, 0},
                                                                  .angular_velocity = {1, 2, 3},
                                                                  .dynamics = BodyDynamics::rigid})};
    }
    VisualSurface ball = fine_ball();
    ball.materials = {{.name = "skin", .color = {1, 0.5, 0}, .opacity = 0.25, .texture = "skin.png"}, {.name = "b"}};
    ball.material.assign(ball.triangles.size(), 1);
    ball.file = "ball.obj";
    Visuals visuals(world);
    for (const BodyHandle body : bodies) CHECK(visuals.set(body, ball).warning.empty());
    CHECK(visuals.fit(bodies[0]).farthest == Approx(0.1));
    const auto at_rest = visuals.positions(bodies[0]);
    CHECK(largest_error(at_rest, fine_ball().nodes) < 1e-15);
    CHECK(world.state_hash() == plain.state_hash());
    world.advance(0.01);
    plain.advance(0.01);
    CHECK(world.state_hash() == plain.state_hash());
    World loaded = World::from_bytes(world.to_bytes()), copy = world.clone();
    CHECK(loaded.state_hash() == world.state_hash());
    for (const BodyHandle body : bodies) {
        for (World* tested : {&loaded, &copy}) {
            Visuals others(*tested);
            CHECK(*others.get(body) == *visuals.get(body));
            CHECK(others.positions(body) == visuals.positions(body));
        }
        const MotionKey pose = world.pose(body);
        const Mat3 rotation = rotation_matrix(pose.rotation);
        // free fall and rotation; the first body deforms only by rounding
        const auto expected =
            moved(fine_ball().nodes, [&](const Vec3& x) -> Vec3 { return rotation * x + pose.position; });
        CHECK(largest_error(visuals.positions(body), expected) < 1e-12);
    }
    world.set_dynamics(bodies[0], BodyDynamics::rigid);
    CHECK(visuals.get(bodies[0]) != nullptr);
    world.reset();
    CHECK(largest_error(visuals.positions(bodies[0]), at_rest) < 1e-14);
    visuals.remove(bodies[0]);
    CHECK(visuals.get(bodies[0]) == nullptr);
    CHECK(visuals.positions(bodies[0]).empty());
    world.remove(bodies[1]);
    CHECK_THROWS_AS(visuals.get(bodies[1]), SceneError);
    CHECK(*visuals.get(bodies[2]) == ball);
}

TEST_CASE("copies of a body in a scene share a visual surface, also after loading", "[unit][visual]") {
    const TemporaryFolder folder;
    const std::string keys = R"("repeat": {"count": [3, 1, 1], "spacing": [2, 0, 0]}, "visual": )";
    std::ofstream(folder.path() / "thin.obj") << "v 0 0 0\nv 250 0 0\nv 0 0 250\nf 1 2 3\n";
    const auto scene_of = [&](const std::string& visual) {
        return load_scene_text(body_with(keys + visual), folder.path());
    };
    Scene scene = scene_of(R"({"file": "thin.obj", "scale": 1e-3})");
    const World loaded = World::from_bytes(scene.world.to_bytes());
    for (const World* world : {&std::as_const(scene.world), &loaded}) {
        const Frame frame = collect_frame(*world);
        REQUIRE(frame.bodies.size() == 3);
        REQUIRE(frame.bodies[0].visual != nullptr);
        CHECK(frame.bodies[0].visual->surface.nodes[1] == Vec3(0.25, 0, 0));
        for (const BodyFrame& body : frame.bodies) CHECK(body.visual == frame.bodies[0].visual);
    }
    CHECK_THROWS_WITH(scene_of("\"missing.obj\""),
                      Contains("body \"block\": bodies[0].visual: found the path of a missing file"));
    CHECK_THROWS_WITH(scene_of(R"({"file": "thin.obj", "scale": 0})"), Contains("visual.scale: found 0"));

    VtkSeries series(folder.path(), "run");
    series.write_frame(collect_frame(scene.world));
    series.write_index();
    std::ifstream in(folder.path() / "run_visual_0000.vtp", std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    CHECK_THAT(file, Contains("NumberOfPoints=\"9\"") && Contains("TCoords=\"texture_coordinates\""));
}

TEST_CASE("a page computes the positions of visual surfaces from those of the body", "[unit][visual]") {
    const Mesh box = coarse_box();
    VisualSurface ball = fine_ball();
    ball.texture_points = {{0.25, 1}, {1, -0.5}, {0, 0}};
    ball.texture_corners.assign(ball.triangles.size(), {0, 1, 2});
    ball.materials = {{.name = "a"}, {.name = "b"}};
    ball.material.assign(ball.triangles.size(), 1);
    ball.material[0] = no_index;
    const BoundVisual bound = bind_visual(ball, box.nodes, box.tetrahedra);
    VisualStream stream;
    CHECK(stream.number_of(bound) == 0);
    CHECK(stream.number_of(bind_visual(fine_ball(), box.nodes, box.tetrahedra)) == 1);
    CHECK(stream.number_of(bound) == 0);
    const std::vector<ReadVisual> read = read_visuals(stream.packed());
    REQUIRE(read.size() == 2);
    CHECK(read[0].triangles == ball.triangles);
    CHECK(read[0].texture_points == ball.texture_points);
    CHECK(read[0].texture_corners == ball.texture_corners);
    CHECK(read[0].material == ball.material);
    CHECK(read[1].texture_points.empty());
    const std::vector<Vec3> after = moved(box.nodes, bent);
    // The weights are rounded to 2^-17, and nodes are up to 2 m apart.
    CHECK(largest_error(read[0].positions(after), visual_positions(bound, after)) < 4 * 2.0 / (1 << 17));
    std::vector<bool> used(box.nodes.size(), false);
    mark_nodes(bound, used);
    for (const auto& corners : read[0].node)
        for (const Index node : corners) CHECK(used[static_cast<std::size_t>(node)]);
}

TEST_CASE("a visual surface with a wrong index is refused by its field", "[unit][visual]") {
    World world{Settings{}};
    const auto body = world.add_body(coarse_box(), {.material = world.add_material({}), .name = "box"});
    VisualSurface ball = fine_ball();
    ball.material.assign(ball.triangles.size(), 1);
    ball.materials.push_back({.name = "only"});
    CHECK_THROWS_WITH(Visuals(world).set(body, ball),
                      "visual surface of body 'box': material: found 1, expected an index below 1, or -1");
    ball.material.pop_back();
    CHECK_THROWS_WITH(Visuals(world).set(body, ball),
                      Contains("material: found") && Contains("entries, expected none"));
    ball.material.clear();
    ball.triangles[0][1] = 100000;
    CHECK_THROWS_WITH(Visuals(world).set(body, ball), Contains("triangles: found 100000, expected an index below"));
    CHECK(Visuals(world).get(body) == nullptr);
}

}  // namespace skerry::test::visual_test
