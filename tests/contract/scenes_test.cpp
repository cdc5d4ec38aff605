// Every shipped scene loads and runs.
#include <skerry/scene.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

namespace skerry::test::scenes_test {

namespace {

std::vector<std::filesystem::path> scene_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SKERRY_SOURCE_DIR "/scenes"))
        // The test program_fill runs filled.json, because it needs an optional mesher.
        if (entry.path().extension() == ".json" && entry.path().filename() != "filled.json")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

TEST_CASE("every scene that is shipped runs", "[contract][scene]") {
    const std::vector<std::filesystem::path> files = scene_files();
    CHECK(files.size() >= 26);
    for (const std::filesystem::path& file : files) {
        INFO(file);
        skerry::Scene scene = skerry::load_scene(file);
        REQUIRE_FALSE(scene.world.bodies().empty());
        CHECK(scene.seconds > 0);
        for (int i = 0; i < 5; ++i) {
            const skerry::StepReport report = scene.world.advance(scene.world.stable_step());
            INFO(report.message());
            REQUIRE(report.ok());
        }
        for (const skerry::BodyHandle body : scene.world.bodies())
            for (const skerry::Vec3& position : scene.world.positions(body)) REQUIRE(position.allFinite());
    }
}

}  // namespace skerry::test::scenes_test
