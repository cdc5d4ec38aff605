// Rules of the house that a reader of one change does not see.
#include <catch2/catch.hpp>

#include "tests/contract/project_files.h"

TEST_CASE("no file is longer than 500 lines", "[contract]") {
    for (const skerry::test::ProjectFile& file : skerry::test::project_files()) {
        INFO(file.path);
        CHECK(file.lines.size() <= 500);
    }
}

TEST_CASE("nothing is left to do later", "[contract]") {
    // Put together from parts, so that this file is not one that it finds.
    const std::vector<std::string> marks{std::string("TO") + "DO", std::string("FIX") + "ME", std::string("not imple") + "mented"};
    for (const skerry::test::ProjectFile& file : skerry::test::project_files())
        for (std::size_t i = 0; i < file.lines.size(); ++i)
            for (const std::string& mark : marks) {
                INFO(file.path << ":" << i + 1 << ": " << file.lines[i]);
                CHECK(file.lines[i].find(mark) == std::string::npos);
            }
}
