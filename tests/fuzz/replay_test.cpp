// Every test run reads again all files that the fuzzers have found. See docs/fuzzing.md.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "components/split_mix.h"
#include "readers.h"

namespace skerry::test::replay_test {

using skerry::SplitMix;

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> found_cases(std::string_view reader) {
    std::vector<fs::path> files;
    const fs::path folder = fs::path(SKERRY_SOURCE_DIR) / "tests/fuzz/found" / reader;
    if (fs::exists(folder))
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

TEST_CASE("every file that a fuzzer has found is read or refused", "[unit]") {
    for (const FileReaderCase& reader : all_readers())
        for (const fs::path& file : found_cases(reader.name)) {
            INFO(file.string());
            std::ifstream stream(file, std::ios::binary);
            const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
            REQUIRE_NOTHROW(reader.read({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
        }
}

TEST_CASE("saved worlds with any values in them are refused, or moved by a step", "[unit][slow]") {
    SplitMix random(5);
    for (int i = 0; i < 1500; ++i) {
        std::vector<std::uint8_t> bytes(1 + 5 * (1 + random.next() % 3));
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.next());
        CAPTURE(i);
        REQUIRE_NOTHROW(read_saved_values_bytes(bytes));
    }
}

TEST_CASE("found cases lie in folders named after readers", "[unit]") {
    const fs::path folder = fs::path(SKERRY_SOURCE_DIR) / "tests/fuzz/found";
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        CHECK(std::any_of(all_readers().begin(), all_readers().end(),
                          [&](const FileReaderCase& reader) { return reader.name == name; }));
    }
}

}  // namespace skerry::test::replay_test
