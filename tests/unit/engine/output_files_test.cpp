#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <stdexcept>

#include "engine/base/write_file.h"
#include "engine/output/vtk/vtk_series.h"
#include "output_sample.h"
#include "skerry/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::output_files_test {

namespace {

namespace fs = std::filesystem;

int count_files(const TemporaryFolder& folder, const std::string& part) {
    int found = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        found += entry.path().filename().string().find(part) != std::string::npos;
    return found;
}

std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("a file is replaced as a whole, and a failure leaves the old file and nothing beside it", "[unit][output]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "made" / "on" / "demand.txt";
    write_file(file, [](std::ostream& out) { out << "first"; });
    write_file(file, [&](std::ostream& out) {
        out << "second";
        CHECK(content(file) == "first");
    });
    CHECK(content(file) == "second");
    CHECK_THROWS_AS(write_file(file,
                               [](std::ostream& out) {
                                   out << "third";
                                   throw std::runtime_error("half way");
                               }),
                    std::runtime_error);
    CHECK_THROWS_AS(write_file(file, [](std::ostream& out) { out.setstate(std::ios::badbit); }), SceneError);
    CHECK(content(file) == "second");
    CHECK(count_files(folder, ".part") == 0);
}

TEST_CASE("a folder that cannot be made is named, with the error found", "[unit][output]") {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "plain_file";
    std::ofstream(file) << "not a folder";
    for (const fs::path& place : {file, file / "below"}) {
        const std::string complaint = message_of([&] { VtkSeries(place, "run"); });
        CHECK(complaint.find(place.string()) != std::string::npos);
        CHECK(complaint.find("found ") != std::string::npos);
        CHECK(complaint.find("expected a folder") != std::string::npos);
    }
    fs::create_directories(folder.path() / "taken");
    CHECK(message_of([&] { write_file(folder.path() / "taken", [](std::ostream& out) { out << 1; }); }).find("taken") !=
          std::string::npos);
    CHECK(message_of([&] { VtkSeries(folder.path(), "a/b"); }).find("\"a/b\"") != std::string::npos);
    CHECK(message_of([&] { VtkSeries(folder.path(), ""); }).find("expected a file name") != std::string::npos);
}

TEST_CASE("colliders are written again only when one of them came, went or moved", "[unit][output]") {
    const TemporaryFolder folder;
    OutputSample sample(2, 0, 4);
    VtkSeries series(folder.path(), "run");
    Frame frame = sample.frame(0);
    series.write_frame(frame);
    frame.time = 1;
    series.write_frame(frame);
    CHECK(count_files(folder, "run_colliders_") == 1);
    frame.colliders.back().pose.position.x() += 1e-9;
    series.write_frame(frame);
    CHECK(count_files(folder, "run_colliders_") == 2);
    frame.colliders.pop_back();
    series.write_frame(frame);
    CHECK(count_files(folder, "run_colliders_") == 3);
    CHECK(count_files(folder, "run_bodies_") == 4);
    CHECK(count_files(folder, "run.pvd") == 0);
    series.write_index();
    const std::string index = content(folder.path() / "run.pvd");
    // Every time step names all three parts. The second step refers to the colliders of the first.
    CHECK(index.find("timestep=\"1\" group=\"\" part=\"2\" name=\"colliders\" file=\"run_colliders_0000.vtp\"") !=
          std::string::npos);
}

TEST_CASE("a frame of nothing is written, too", "[unit][output]") {
    const TemporaryFolder folder;
    VtkSeries series(folder.path(), "run");
    series.write_frame(Frame{});
    series.write_index();
    CHECK(content(folder.path() / "run_bodies_0000.vtu").find("NumberOfPoints=\"0\" NumberOfCells=\"0\"") !=
          std::string::npos);
    CHECK(content(folder.path() / "run_contacts_0000.vtp").find("NumberOfVerts=\"0\"") != std::string::npos);
    CHECK(count_files(folder, "run_lines_") == 0);
    CHECK(content(folder.path() / "run.pvd").find("lines") == std::string::npos);
}

TEST_CASE("a contact force is its impulse over the time that it stands for, and none without a step",
          "[unit][output]") {
    Contact contact{};
    contact.impulse = {0, 0, 3};
    CHECK(contact.force() == Vec3(0, 0, 0));
    contact.seconds = 0.5;
    CHECK(contact.force() == Vec3(0, 0, 6));
}

TEST_CASE("regions are counted by their highest number", "[unit][output]") {
    std::vector<Contact> contacts(3, Contact{});
    contacts[0].region = 1;
    contacts[1].region = -1;
    contacts[2].region = 0;
    CHECK(count_regions(contacts) == 2);
    CHECK(count_regions({}) == 0);
}

}  // namespace skerry::test::output_files_test
