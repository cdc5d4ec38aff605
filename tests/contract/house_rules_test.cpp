// Project rules that a reader of a single change cannot check.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "tests/contract/project_files.h"

namespace skerry::test::house_rules_test {

TEST_CASE("no file is longer than 500 lines", "[contract]") {
    for (const skerry::test::ProjectFile& file : skerry::test::project_files()) {
        INFO(file.path);
        CHECK(file.lines.size() <= 500);
    }
}

TEST_CASE("no line goes beyond 120 columns", "[contract]") {
    // Columns are characters: continuation bytes of UTF-8 are not counted.
    const auto columns = [](const std::string& line) {
        return std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
    };
    for (const skerry::test::ProjectFile& file : skerry::test::project_files())
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            INFO(file.path << ":" << i + 1 << ": " << file.lines[i]);
            CHECK(columns(file.lines[i]) <= 120);
        }
}

TEST_CASE("nothing is left to do later", "[contract]") {
    // Built from parts so that this file does not match its own pattern.
    const std::vector<std::string> marks{std::string("TO") + "DO", std::string("FIX") + "ME",
                                         std::string("not imple") + "mented"};
    for (const skerry::test::ProjectFile& file : skerry::test::project_files())
        for (std::size_t i = 0; i < file.lines.size(); ++i)
            for (const std::string& mark : marks) {
                INFO(file.path << ":" << i + 1 << ": " << file.lines[i]);
                CHECK(file.lines[i].find(mark) == std::string::npos);
            }
}

/// Comments of a file, with the line on which each begins. Lines that follow each other are one comment.
std::vector<std::pair<std::size_t, std::string>> comments_of(const ProjectFile& file) {
    static const std::regex whole_line("^\\s*///?<? ?(.*)$"), behind_code("^.*\\S.*\\s// ?(.*)$");
    std::vector<std::pair<std::size_t, std::string>> comments;
    bool goes_on = false;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const bool has_comment = file.lines[i].find("//") != std::string::npos;  // expressions are slow
        std::smatch found;
        if (has_comment && std::regex_match(file.lines[i], found, whole_line)) {
            if (!goes_on) comments.emplace_back(i + 1, "");
            comments.back().second += found[1].str() + " ";
            goes_on = true;
            continue;
        }
        goes_on = false;
        if (has_comment && std::regex_match(file.lines[i], found, behind_code))
            comments.emplace_back(i + 1, found[1].str());
    }
    return comments;
}

TEST_CASE("comments are sentences or noun phrases of their own", "[contract]") {
    // These openings mark a fragment that needs the comment above it, or a clause in place of a noun.
    static const std::regex opening("^(What|Of|Whose|By|Behind|The same|As)\\b.*"), quoted("`[^`]*`|\"[^\"]*\""),
        noun(".*\\b[Ww]hat\\b.*");
    std::size_t seen = 0;
    for (const ProjectFile& file : skerry::test::project_files()) {
        const bool checked = std::ranges::any_of(std::array{"engine/", "systems/", "components/", "jobs/"},
                                                 [&](const char* folder) { return file.path.starts_with(folder); });
        if (!checked || !(file.path.ends_with(".h") || file.path.ends_with(".cpp"))) continue;
        for (const auto& [line, comment] : comments_of(file)) {
            ++seen;
            INFO(file.path << ":" << line << ": " << comment);
            CHECK_FALSE(std::regex_match(comment, opening));
            CHECK_FALSE(std::regex_match(std::regex_replace(comment, quoted, ""), noun));
        }
    }
    CHECK(seen > 1000);
}

TEST_CASE("the list of stages captures nothing", "[contract]") {
    // Data that a stage reaches through a lambda capture is missing from the stage's declared accesses.
    static const std::regex capture("\\[[&=a-z][^\\]]*\\] *[({]");
    int found = 0;
    for (const skerry::test::ProjectFile& file : skerry::test::project_files()) {
        const bool lists_stages =
            file.path == "engine/world/step/step.cpp" || file.path.starts_with("engine/world/step/models/") ||
            file.path.starts_with("engine/world/step/forces/") || file.path.starts_with("engine/world/step/laws/");
        if (!lists_stages) continue;
        ++found;
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            INFO(file.path << ":" << i + 1 << ": " << file.lines[i]);
            CHECK_FALSE(std::regex_search(file.lines[i], capture));
        }
    }
    CHECK(found == 16);
}

}  // namespace skerry::test::house_rules_test
