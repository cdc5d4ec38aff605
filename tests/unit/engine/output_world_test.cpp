// Writers on a real world: their output against the values of the world.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/output/collect_frame.h"
#include "engine/output/page/page_data.h"
#include "page_stream_reader.h"
#include "skerry/cable.h"
#include "skerry/fibre.h"
#include "skerry/joint.h"
#include "skerry/output.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "skerry/world.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::output_world_test {

namespace {

namespace fs = std::filesystem;

World box_on_floor(BodyHandle& box) {
    World world;
    const MaterialHandle rubber = world.add_material(
        {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5, .damping = 20});
    box = world.add_body(mesh::box({0.1, 0.1, 0.1}, {2, 2, 2}),
                         {.material = rubber, .position = {0, 0, 0.052}, .name = "box"});
    world.add_collider(Plane{.normal = {0, 0, 2}}, {.name = "floor"});
    world.add_collider(Bucket{}, {.position = {0, 0, -0.5}, .motion = {.velocity = {0, 0, -1}}, .name = "bucket"});
    return world;
}

}  // namespace

TEST_CASE("a frame has the bodies, colliders, contacts and energies of its world, and forces that carry the weight",
          "[unit][output]") {
    BodyHandle box;
    World world = box_on_floor(box);
    REQUIRE(world.advance(1).ok());
    REQUIRE(world.advance(0.01).ok());
    const Frame frame = collect_frame(world);

    CHECK(frame.time == world.time());
    REQUIRE(frame.bodies.size() == 1);
    CHECK(frame.bodies[0].handle == box);
    CHECK(frame.bodies[0].name == "box");
    CHECK(frame.bodies[0].position.data() == world.positions(box).data());
    CHECK(frame.bodies[0].stress == world.stress(box));
    CHECK(frame.bodies[0].strain == world.strain(box));
    CHECK(frame.bodies[0].node_stress == world.node_stress(box));
    CHECK(frame.bodies[0].node_strain == world.node_strain(box));
    CHECK(frame.bodies[0].node_mesh_error.size() == world.node_stress(box).size());
    const Frame of_fields = collect_frame(world, FrameContent::node_fields);
    CHECK(of_fields.bodies[0].node_stress == world.node_stress(box));
    CHECK(of_fields.bodies[0].node_strain == world.node_strain(box));
    CHECK(of_fields.bodies[0].node_mesh_error.empty());
    CHECK(PageStream().pack(of_fields).size() > 0);
    REQUIRE(frame.colliders.size() == 2);
    CHECK(frame.colliders[1].name == "bucket");
    CHECK(frame.colliders[1].pose.position.z() == Approx(-0.5 - world.time()));
    CHECK(frame.energy.elastic == world.energy().elastic);
    REQUIRE(frame.contacts.size() == world.contacts().size());

    Vec3 force = Vec3::Zero();
    for (const Contact& contact : frame.contacts) force += contact.force();
    // A second of damping at 20/s leaves e^-20 of the landing. A tenth covers the variation of a contact between steps.
    CHECK(force.z() == Approx(world.mass(box) * 9.81).epsilon(0.1));
}

TEST_CASE("a world that bodies join and leave is written as a series and as a page", "[unit][output]") {
    const TemporaryFolder temporary;
    const fs::path& folder = temporary.path();
    BodyHandle box;
    World world = box_on_floor(box);
    {
        VtkWriter series(folder / "series", "run");
        PageWriter page(folder / "run.html", "A box and a ball");
        BodyHandle ball;
        for (int i = 0; i < 6; ++i) {
            if (i == 2)
                ball = world.add_body(mesh::ball(0.05, 4),
                                      {.material = world.add_material({}), .position = {0, 0, 0.2}, .name = "ball"});
            if (i == 4) world.remove(box);
            REQUIRE(world.advance(0.01).ok());
            series.write_frame(world);
            page.add_frame(world);
        }
        series.close();
        page.close(world);
        CHECK(fs::exists(folder / "run.html"));
    }
    for (const char* file : {"run.pvd", "run_bodies_0005.vtu", "run_contacts_0005.vtp", "run_colliders_0005.vtp"})
        CHECK(fs::exists(folder / "series" / file));
    std::ifstream in(folder / "run.html");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    CHECK(text.find("\"bodies\":[\"box\",\"ball\"]") != std::string::npos);
}

TEST_CASE("a frame of a film is later than the frame before, and a film that was closed takes no frame",
          "[unit][output]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "run.usd";
    BodyHandle box;
    World world = box_on_floor(box);
    FilmWriter film(file, {.frame_step = 0.01});
    film.add_frame(world);
    CHECK_THROWS_WITH(film.add_frame(world), Catch::Contains("time of the frame: found 0.000000 s, expected a time "
                                                             "after that of the previous frame, 0.000000 s"));
    REQUIRE(world.advance(0.01).ok());
    film.add_frame(world);
    CHECK_FALSE(fs::exists(file));
    film.close();
    CHECK(fs::exists(file));
    CHECK_THROWS_WITH(film.close(), Catch::Contains("found a film that was closed"));
}

TEST_CASE("a film that is not closed leaves the film of an earlier run", "[unit][output]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "run.usd";
    std::ofstream(file) << "earlier";
    BodyHandle box;
    const World world = box_on_floor(box);
    {
        FilmWriter film(file, {});
        film.add_frame(world);
    }
    CHECK(fs::file_size(file) == 7);
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("stretch and stress of fibres are in frames and in files for ParaView", "[unit][output]") {
    World world;
    const Mesh cube = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const MaterialHandle rubber = world.add_material({});
    const BodyHandle muscle = world.add_body(cube, {.material = rubber});
    world.add_body(cube, {.material = rubber, .position = {1, 0, 0}});
    const FibreHandle fibres = Fibres(world).add(
        {.body = muscle, .tetrahedra = {1, 3}, .direction = {{1, 0, 0}}, .stiffness = 1e4, .tension = 2e3});
    std::vector<Vec3> stretched;
    for (const Vec3& x : cube.nodes) stretched.emplace_back(1.25 * x.x(), x.y(), x.z());
    world.set_positions(muscle, stretched);
    const Frame frame = collect_frame(world);
    const FibreState state = Fibres(world).state(fibres);
    CHECK(state.stress[0] > 2e3);
    REQUIRE(frame.bodies[0].fibre_stretch.size() == cube.tetrahedra.size());
    for (std::size_t t = 0; t < cube.tetrahedra.size(); ++t) {
        const bool with = t == 1 || t == 3;
        CHECK(frame.bodies[0].fibre_stretch[t] == Approx(with ? 1.25 : 1));
        CHECK(frame.bodies[0].fibre_stress[t] == (with ? state.stress[t / 2] : 0));
    }
    CHECK(frame.bodies[1].fibre_stretch.empty());
    const TemporaryFolder folder;
    for (const bool has : {true, false}) {
        const fs::path place = folder.path() / (has ? "with" : "without");
        VtkWriter series(place, "run");
        series.write_frame(world);
        series.close();
        std::ifstream file(place / "run_bodies_0000.vtu", std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        for (const char* const name : {"\"fibre_stretch\"", "\"fibre_stress\""})
            CHECK((text.find(name) != std::string::npos) == has);
        if (has) Fibres(world).remove(fibres);
    }
}

TEST_CASE("a rigid body without tetrahedra is written as the triangles of its surface", "[unit][output]") {
    BodyHandle box;
    World world = box_on_floor(box);
    world.add_body(mesh::boundary(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1})),
                   {.material = world.add_material({}), .position = {1, 0, 1}, .dynamics = BodyDynamics::rigid});
    const Frame frame = collect_frame(world);
    CHECK(frame.bodies[1].stress == std::vector<Mat3>(12, Mat3::Zero()));
    CHECK(frame.bodies[1].material == std::vector<Index>(12, 1));
    const TemporaryFolder folder;
    VtkWriter series(folder.path(), "run");
    series.write_frame(world);
    series.close();
    std::ifstream file(folder.path() / "run_bodies_0000.vtu", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    CHECK(text.find("NumberOfPoints=\"35\" NumberOfCells=\"60\"") != std::string::npos);
    const std::string types = std::string(48, '\x0a') + std::string(12, '\x05');  // tetrahedra, then triangles
    CHECK(text.find(types) != std::string::npos);
}

TEST_CASE("contacts of the page name both bodies or the collider, and have all their values", "[unit][output]") {
    BodyHandle lower;
    World world = box_on_floor(lower);
    world.add_body(mesh::box({0.08, 0.08, 0.08}, {2, 2, 2}),
                   {.material = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 20}),
                    .position = {0, 0, 0.144},
                    .name = "upper"});
    PageData data;
    REQUIRE(world.advance(1).ok());
    data.add(collect_frame(world));
    REQUIRE(world.advance(0.01).ok());
    data.add(collect_frame(world));
    const ReadRun run = read_run(data.packed_frames());
    Real on_floor = 0, between = 0;
    int found_again = 0;
    for (const ReadContact& contact : run.frames[1].contacts) {
        found_again += contact.row_prev >= 0;
        if (contact.collider >= 0) {
            CHECK(contact.collider == 0);
            CHECK(contact.second == -1);
            on_floor += contact.normal_force;
        } else {
            CHECK(contact.first + contact.second == 1);
            between += contact.normal_force;
        }
    }
    const Real weight = 9.81 * 1000, lower_volume = 0.1 * 0.1 * 0.1, upper_volume = 0.08 * 0.08 * 0.08;
    CHECK(on_floor == Approx(weight * (lower_volume + upper_volume)).epsilon(0.1));
    CHECK(between == Approx(weight * upper_volume).epsilon(0.1));
    CHECK(found_again > 0);
}

TEST_CASE("lines have the points and forces of joints, ties, cables and springs, and lose nodes that break off",
          "[unit][output]") {
    World world;
    const MaterialHandle rubber = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 20});
    const BodyHandle arm = world.add_body(mesh::box({0.3, 0.1, 0.1}, {3, 1, 1}),
                                          {.material = rubber, .dynamics = BodyDynamics::rigid, .name = "arm"});
    const Mesh pad_mesh = mesh::box({0.1, 0.1, 0.1}, {1, 1, 1});
    const BodyHandle pad = world.add_body(
        pad_mesh, {.material = rubber, .position = {0.1, 0, 0.1}, .dynamics = BodyDynamics::explicit_elastic});
    std::vector<Index> bottom;
    for (std::size_t n = 0; n < pad_mesh.nodes.size(); ++n)
        if (pad_mesh.nodes[n].z() < 0) bottom.push_back(static_cast<Index>(n));
    const auto hinge = Joints(world).add({.kind = JointKind::hinge, .first = arm, .axis = {0, 1, 0}});
    const auto tie = Ties(world).add({.body = pad, .nodes = bottom, .to_body = arm});
    const auto cable = Cables(world).add(
        {.points = {{.point = {-0.15, 0, 0.4}}, {.body = arm, .point = {-0.15, 0, 0}}, {.point = {-0.15, 0, -0.1}}},
         .drive = {.tension = TimeTable(2)}});
    const auto spring = Springs(world).add(
        {.first = {.body = arm, .point = {0.15, 0, 0}}, .second = {.point = {0.15, 0, 0.5}}, .stiffness = 100});
    REQUIRE(world.advance(0.02).ok());

    std::vector<LineFrame> lines = collect_frame(world).lines;
    REQUIRE(lines.size() == 4);
    const JointState joint = Joints(world).state(hinge);
    // The axis reaches one radius of gyration to each side: that of a box with edges a, b, c is sqrt((a^2+b^2+c^2)/12).
    const Vec3 half_axis = std::sqrt((0.09 + 0.01 + 0.01) / 12) * joint.axis;
    CHECK(lines[0].kind == LineKind::joint);
    REQUIRE(lines[0].points.size() == 2);
    CHECK((lines[0].points[0] - joint.point + half_axis).norm() < 1e-6);
    CHECK((lines[0].points[1] - joint.point - half_axis).norm() < 1e-6);
    CHECK(lines[0].force == std::vector<Real>(2, joint.force.norm()));
    const TieState tied = Ties(world).state(tie);
    REQUIRE(lines[1].points.size() == 4);
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(lines[1].points[k] == world.positions(pad)[static_cast<std::size_t>(bottom[k])]);
        CHECK(lines[1].force[k] == tied.nodes[k].force.norm());
    }
    const CableState pulled = Cables(world).state(cable);
    REQUIRE(lines[2].points.size() == 3);
    CHECK(lines[2].points[1] == pulled.points[1].point);
    CHECK(lines[2].force == std::vector<Real>{2, 2, 2});
    CHECK(lines[3].points[1] == Vec3(0.15, 0, 0.5));
    CHECK(lines[3].force == std::vector<Real>(2, Springs(world).state(spring).force));

    Ties(world).set_break_force(tie, 1e-6);
    Cables(world).remove(cable);
    REQUIRE(world.advance(0.001).ok());
    lines = collect_frame(world).lines;
    REQUIRE(lines.size() == 3);
    CHECK(lines[1].kind == LineKind::tie);
    CHECK(lines[1].points.empty());
}

}  // namespace skerry::test::output_world_test
