// Time series of probes: recorded values against those of the world, and the files of the series.
#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <iterator>

#include "engine/hdf5/hdf5_file.h"
#include "skerry/recorder.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::recorder_test {

namespace fs = std::filesystem;

namespace {

struct Swing {
    World world;
    BodyHandle bar, ball;
    AttachmentHandle hold;
    ColliderHandle floor;

    Swing() {
        const auto rubber = world.add_material({.young_modulus = 1e5, .friction = 0.5});
        bar = world.add_body(mesh::box({0.2, 0.1, 0.1}, {4, 2, 2}), {.material = rubber, .position = {0, 0, 0.5}});
        ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {1, 0, 0.1}});
        std::vector<Index> left_nodes;
        for (std::size_t n = 0; n < world.positions(bar).size(); ++n)
            if (world.positions(bar)[n].x() < -0.09) left_nodes.push_back(static_cast<Index>(n));
        hold = world.attach(bar, left_nodes);
        floor = world.add_collider(Plane{});
    }

    std::vector<RecordedProbe> probes() const {
        return {{"tip", probe_point(world, bar, {0.1, 0, 0.5})},
                {"bar", BodyProbe{bar}},
                {"landing", BodyForceProbe{ball, floor}},
                {"floor, all", ColliderForceProbe{floor}},
                {"clamp", ReactionProbe{hold}},
                {"energy", EnergyProbe{}},
                {"stress", StressProbe{bar}},
                {"volume", VolumeProbe{bar}}};
    }
};

std::size_t column(const Recorder& recorder, const std::string& heading) {
    for (std::size_t c = 0; c < recorder.columns().size(); ++c)
        if (recorder.columns()[c].heading() == heading) return c;
    FAIL("no column " << heading);
    return 0;
}

std::vector<std::string> lines_of(const fs::path& file) {
    std::ifstream in(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

}  // namespace

TEST_CASE("rows of a recorder have values at multiples of a time, and sums of impulses between them", "[unit]") {
    Swing swing;
    World& world = swing.world;
    Recorder recorder(world, swing.probes(), 0.05);
    REQUIRE(world.measures_forces());
    recorder.sample(world);
    Vec3 impulse = Vec3::Zero();
    const Vec3 tip = world.positions(swing.bar)[0] * 0 + Vec3(0.1, 0, 0.5);
    std::size_t rows = 1;
    for (int call = 1; call <= 40; ++call) {
        REQUIRE(world.advance(0.01).ok());
        recorder.sample(world);
        recorder.sample(world);  // a time that was already sampled adds no row
        impulse += world.forces().on(swing.ball, swing.floor).impulse;
        if (call % 5 != 0) continue;
        REQUIRE(recorder.row_count() == ++rows);
        const auto row = recorder.row(rows - 1);
        CHECK(row[0] == world.time());
        CHECK(row[column(recorder, "landing.impulse_z [N s]")] == Approx(impulse.z()).margin(1e-15));
        CHECK(row[column(recorder, "landing.force_z [N]")] == Approx(impulse.z() / 0.05).margin(1e-12));
        CHECK(row[column(recorder, "floor, all.impulse_z [N s]")] == Approx(-impulse.z()).margin(1e-15));
        CHECK(row[column(recorder, "energy.elastic [J]")] == world.energy().elastic);
        CHECK(row[column(recorder, "bar.position_z [m]")] == world.center_of_mass(swing.bar).z());
        CHECK(row[column(recorder, "tip.displacement_z [m]")] ==
              Approx(row[column(recorder, "tip.position_z [m]")] - tip.z()).margin(1e-15));
        CHECK(row[column(recorder, "stress.largest_von_mises [Pa]")] > 0);
        CHECK(row[column(recorder, "volume.smallest_volume_ratio [1]")] < 1);
        CHECK(row[column(recorder, "volume.smallest_volume_ratio [1]")] > 0.8);
        impulse.setZero();
    }
    CHECK(std::isnan(recorder.row(0)[column(recorder, "landing.force_z [N]")]));
    CHECK(recorder.row(0)[column(recorder, "tip.displacement_z [m]")] == 0);
    CHECK(recorder.row(8)[column(recorder, "clamp.force_z [N]")] > 10);
    CHECK(recorder.row(8)[column(recorder, "tip.velocity_z [m/s]")] != 0);
    Real landed = 0;
    for (std::size_t i = 1; i < rows; ++i) landed += recorder.row(i)[column(recorder, "landing.impulse_z [N s]")];
    CHECK(landed > 0.1);
}

TEST_CASE("poses, velocities and nodes are recorded as the world has them", "[unit]") {
    Swing swing;
    World& world = swing.world;
    world.set_velocity(swing.floor, {0, 0, 0.1}, {0, 0, 0.2});
    const auto rigid = world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = world.add_material({}),
                                                                              .position = {2, 0, 1},
                                                                              .rotation = {0.3, 0, 0},
                                                                              .velocity = {1, 0, 0},
                                                                              .angular_velocity = {0, 2, 0},
                                                                              .dynamics = BodyDynamics::rigid});
    Recorder recorder(world, {{"ball", PoseProbe{swing.ball}},
                              {"floor", PoseProbe{swing.floor}},
                              {"hold", PoseProbe{swing.hold}},
                              {"rigid", VelocityProbe{rigid}},
                              {"soft", VelocityProbe{swing.ball}},
                              {"plane", VelocityProbe{swing.floor}},
                              {"shape", NodesProbe{swing.bar}}});
    world.set_velocity(swing.ball, {0, 0.5, 0}, {0.1, 0, 0});
    recorder.sample(world);
    CHECK(recorder.row(0)[column(recorder, "rigid.velocity_x [m/s]")] == Approx(1));
    CHECK(recorder.row(0)[column(recorder, "rigid.angular_velocity_y [rad/s]")] == Approx(2));
    CHECK(recorder.row(0)[column(recorder, "soft.velocity_y [m/s]")] == Approx(0.5));
    CHECK(recorder.row(0)[column(recorder, "soft.angular_velocity_x [rad/s]")] == Approx(0.1));
    REQUIRE(world.advance(0.01).ok());
    recorder.sample(world);
    const auto row = recorder.row(1);
    const auto check_pose = [&](const std::string& probe, const MotionKey& pose) {
        for (int k = 0; k < 3; ++k) {
            const std::string axis(1, static_cast<char>('x' + k));
            CHECK(row[column(recorder, probe + ".position_" + axis + " [m]")] == pose.position[k]);
            CHECK(row[column(recorder, probe + ".rotation_" + axis + " [rad]")] == pose.rotation[k]);
        }
    };
    check_pose("ball", world.pose(swing.ball));
    check_pose("floor", world.pose(swing.floor));
    check_pose("hold", world.pose(swing.hold));
    CHECK(row[column(recorder, "floor.position_z [m]")] == Approx(1e-3));
    CHECK(row[column(recorder, "plane.velocity_z [m/s]")] == Approx(0.1));
    CHECK(row[column(recorder, "plane.angular_velocity_z [rad/s]")] == Approx(0.2));
    const std::size_t first = column(recorder, "shape.position_x_0 [m]");
    for (std::size_t n = 0; n < world.positions(swing.bar).size(); ++n)
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(row[first + 3 * n + k] == world.positions(swing.bar)[n][static_cast<Eigen::Index>(k)]);
}

TEST_CASE("series are written as CSV and HDF5 with all digits and units, and read back", "[unit]") {
    const TemporaryFolder folder;
    Swing swing;
    Recorder recorder(swing.world, swing.probes());
    const fs::path streamed = folder.path() / "streamed.csv";
    recorder.stream_csv(streamed);
    CHECK(lines_of(streamed).size() == 1);
    recorder.sample(swing.world);
    for (int call = 0; call < 5; ++call) {
        REQUIRE(swing.world.advance(0.01).ok());
        recorder.sample(swing.world);
        CHECK(lines_of(streamed).size() == recorder.row_count() + 1);  // at once: a killed run loses nothing
    }
    recorder.write_csv(folder.path() / "whole.csv");
    const std::vector<std::string> lines = lines_of(streamed);
    CHECK(lines == lines_of(folder.path() / "whole.csv"));
    CHECK(lines[0].starts_with("time [s],tip.position_x [m],"));
    CHECK(lines[0].find("\"floor, all.force_z [N]\"") != std::string::npos);
    CHECK(lines[1].find("nan") != std::string::npos);
    CHECK(std::strtod(lines[3].c_str(), nullptr) == recorder.row(2)[0]);

    recorder.write_hdf5(folder.path() / "series.h5");
    {
        const Hdf5File file(folder.path() / "series.h5", "a series");
        const std::vector<Real> found = file.reals("/energy/potential");
        REQUIRE(found.size() == recorder.row_count());
        const std::size_t c = column(recorder, "energy.potential [J]");
        for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == recorder.row(i)[c]);
        CHECK(file.reals("/time").back() == swing.world.time());
    }
    std::ifstream in(folder.path() / "series.h5", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    CHECK(bytes.find("unit") != std::string::npos);
    CHECK(bytes.find("m/s") != std::string::npos);
    // No partial file remains.
    for (const auto& entry : fs::directory_iterator(folder.path())) CHECK(entry.path().extension() != ".part");
}

TEST_CASE("a stream goes on with the whole rows of its file up to a time, of the same probes alone", "[unit]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "series.csv";
    Swing swing;
    {
        Recorder first(swing.world, {{"energy", EnergyProbe{}}});
        first.stream_csv(file);
        for (int call = 0; call < 6; ++call) {
            first.sample(swing.world);
            REQUIRE(swing.world.advance(0.01).ok());
        }
    }
    std::ofstream(file, std::ios::app) << "0.0499";  // a truncated row
    Recorder second(swing.world, {{"energy", EnergyProbe{}}});
    second.stream_csv(file, 0.0301);
    CHECK(lines_of(file).size() == 1 + 4);
    CHECK(lines_of(file).back().starts_with("0.03"));
    Recorder other(swing.world, {{"other", EnergyProbe{}}});
    CHECK_THROWS_WITH(other.stream_csv(file, 1.0), Catch::Contains("column headings of the recorded probes"));
    CHECK(lines_of(file).size() == 1 + 4);
}

TEST_CASE("a point inside a body follows its material, and an outer point is refused with the nearest body", "[unit]") {
    Swing swing;
    const Vec3 place(0.033, 0.012, 0.487);
    const PointProbe point = probe_point(swing.world, swing.bar, place);
    Vec3 found = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a)
        found += point.weight[a] * swing.world.positions(swing.bar)[static_cast<std::size_t>(point.node[a])];
    CHECK((found - place).norm() < 1e-15);
    const PointProbe close = probe_point(swing.world, swing.bar, {0.11, 0.05, 0.55});
    CHECK(close.weight == std::array<Real, 4>{1, 0, 0, 0});
    CHECK_THROWS_WITH(probe_point(swing.world, swing.bar, {3, 0, 0}),
                      Catch::Contains("(3, 0, 0) m") && Catch::Contains("the nearest node is"));
}

TEST_CASE("bad probes are refused by name, field, value found and value expected", "[unit]") {
    Swing swing;
    World& world = swing.world;
    const auto refused = [&](const RecordedProbe& probe, const char* said) {
        INFO(said);
        CHECK_THROWS_WITH(Recorder(world, {probe}), Catch::Contains("probe \"" + probe.name + "\"") &&
                                                        Catch::Contains("expected") && Catch::Contains(said));
    };
    refused({"", EnergyProbe{}}, "heads columns");
    refused({"a/b", EnergyProbe{}}, "without /");
    refused({"line\nbreak", EnergyProbe{}}, "control characters");
    refused({"time", EnergyProbe{}}, "other than \"time\"");
    refused({"gone", BodyProbe{}}, "a handle to an existing object of this world");
    refused({"gone", VolumeProbe{}}, "a handle to an existing object of this world");
    refused({"gone", StressProbe{}}, "a handle to an existing object of this world");
    refused({"gone", ReactionProbe{}}, "a handle to an existing object of this world");
    refused({"gone", ColliderForceProbe{}}, "a handle to an existing object of this world");
    refused({"gone", BodyForceProbe{swing.bar, BodyHandle{}}}, "a handle to an existing object of this world");
    refused({"node", StressProbe{swing.bar, {0, 4000}}}, "node 4000");
    refused({"node", StressProbe{swing.bar, {-1}}}, "node -1");
    refused({"weights", PointProbe{swing.bar, {0, 1, 2, 3}, {1, 1, 0, 0}}}, "sum is 2");
    refused({"weights", PointProbe{swing.bar, {0, 1, 2, 3}, {std::nan(""), 1, 0, 0}}}, "sum is");
    CHECK_THROWS_WITH(Recorder(world, {{"one", EnergyProbe{}}, {"one", EnergyProbe{}}}),
                      Catch::Contains("a name that an earlier probe has"));
    for (const Real every : {-1.0, std::nan(""), std::numeric_limits<Real>::infinity()})
        CHECK_THROWS_WITH(Recorder(world, {}, every), Catch::Contains("every") && Catch::Contains("a time >= 0"));
    // If a probed body is removed, the error names its probe and the rows stay complete.
    Recorder recorder(world, {{"energy", EnergyProbe{}}, {"ball", BodyProbe{swing.ball}}});
    recorder.sample(world);
    REQUIRE(world.advance(0.01).ok());
    world.remove(swing.ball);
    CHECK_THROWS_WITH(recorder.sample(world), Catch::Contains("probe \"ball\""));
    CHECK(recorder.row_count() == 1);
    const TemporaryFolder folder;
    CHECK_THROWS_AS(recorder.write_csv(folder.path()), SceneError);
    CHECK_THROWS_AS(recorder.write_hdf5(folder.path()), SceneError);
    CHECK_THROWS_AS(recorder.stream_csv(folder.path()), SceneError);
}

}  // namespace skerry::test::recorder_test
