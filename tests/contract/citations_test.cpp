// Every page that a comment, a script or another page cites is in the project, and so is the cited section.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "tests/contract/project_files.h"

namespace skerry::test::citations_test {

namespace {

using skerry::test::ProjectFile;

/// Section numbers in the headings of a page: "## 2 Letters" has 2, "### 2.1 More" has 2.1.
const std::set<std::string>& sections_of(const std::string& page) {
    static const std::regex heading("#+ ([0-9]+(\\.[0-9]+)*) .*");
    static std::map<std::string, std::set<std::string>> known;
    const auto [at, is_new] = known.try_emplace(page);
    if (!is_new) return at->second;
    std::smatch match;
    for (const std::string& line : skerry::test::project_file(page).lines)
        if (std::regex_match(line, match, heading)) at->second.insert(match[1]);
    return at->second;
}

/// True if a decision with this number exists. The name of its file begins with the number.
bool has_decision(const std::string& number) {
    static const std::set<std::string> known = [] {
        std::set<std::string> numbers;
        for (const ProjectFile& file : skerry::test::project_texts())
            if (file.path.starts_with("docs/decisions/")) numbers.insert(file.path.substr(15, 4));
        return numbers;
    }();
    return known.contains(number);
}

/// The path of a cited page in the project, or "" if there is none. Names count from the root or from the folder of the
/// citing file. Links also count from docs/, because scripts write links into its pages.
std::string page_of(const std::string& from, const std::string& name, bool link) {
    const std::string from_root = name.substr(std::min(name.size(), name.find_first_not_of('/')));
    const std::string beside = (std::filesystem::path(from).parent_path() / name).lexically_normal().generic_string();
    for (const std::string& path : {from_root, beside, "docs/" + name})
        if (skerry::test::project_has(path) && (link || path != "docs/" + name || path == beside)) return path;
    return "";
}

/// A line without its indentation and the marks of a comment. A heading keeps its marks.
std::string without_marks(const std::string& path, const std::string& line) {
    std::size_t at = line.find_first_not_of(" \t");
    if (at == std::string::npos) return "";
    const char mark = path.ends_with(".md") ? '>' : line[at] == '#' ? '#' : '/';
    while (at < line.size() && line[at] == mark) ++at;
    while (at < line.size() && line[at] == ' ') ++at;
    return line.substr(at);
}

/// Section numbers that follow the name of a page: " 2.1", " 4 to 6", " 1.2, 3 and 5".
std::vector<std::string> sections_named(const std::string& after) {
    static const std::regex first("^ ([0-9]+(\\.[0-9]+)*)"), next("^(,| and| to|, and) ([0-9]+(\\.[0-9]+)*)");
    std::vector<std::string> numbers;
    std::smatch match;
    std::string rest = after;
    while (std::regex_search(rest, match, numbers.empty() ? first : next)) {
        numbers.push_back(match[numbers.empty() ? 1 : 2]);
        rest = match.suffix();
    }
    return numbers;
}

/// Appends the faults of the citations that begin in `line`. `more` is the text of the next line.
void judge_line(const std::string& path, const std::string& line, const std::string& more,
                std::vector<std::string>& wrong) {
    // Built from parts so that this file does not match its own pattern.
    static const std::regex outside(std::string("(^|[^A-Za-z0-9_/])((\\.\\./)*shared") + "/|\"\\.\\.\" */ *\")");
    static const std::regex page("[A-Za-z0-9_./-]*[A-Za-z0-9_]\\.md(?![A-Za-z0-9_])");
    static const std::regex decision("[Dd]ecisions? ([0-9]{4})|\\[([0-9]{4})\\]\\(");
    static const std::regex link("\\]\\(([A-Za-z0-9_./-]+)\\)");
    if (std::regex_search(line, outside)) wrong.push_back("a path outside of the project");
    const std::string text = line + " " + more;
    for (std::sregex_iterator at(text.begin(), text.end(), page), end; at != end; ++at) {
        if (static_cast<std::size_t>(at->position()) >= line.size()) break;
        const bool is_link = std::string(at->prefix()).ends_with("](");
        const std::string found = page_of(path, at->str(), is_link);
        if (found.empty()) wrong.push_back("no file " + at->str());
        if (found.empty()) continue;
        std::string after = at->suffix();
        if (after.starts_with(")")) after.erase(0, 1);  // end of a link
        for (const std::string& section : sections_named(after))
            if (!sections_of(found).contains(section)) wrong.push_back("no section " + section + " in " + found);
    }
    for (std::sregex_iterator at(line.begin(), line.end(), decision), end; at != end; ++at)
        if (const std::string number = (*at)[1].matched ? (*at)[1] : (*at)[2]; !has_decision(number))
            wrong.push_back("no decision " + number);
    if (!path.ends_with(".md")) return;
    for (std::sregex_iterator at(line.begin(), line.end(), link), end; at != end; ++at) {
        const std::filesystem::path target = std::filesystem::path(path).parent_path() / (*at)[1].str();
        if (!std::filesystem::exists(std::filesystem::path(SKERRY_SOURCE_DIR) / target))
            wrong.push_back("no file " + (*at)[1].str());
    }
}

std::vector<std::string> objections(const ProjectFile& file) {
    // Quick filter: a line without any of these strings has no citation for judge_line.
    static const std::vector<std::string> signs{".md", std::string("shared") + "/", "ecision", "](", "\"..\""};
    std::vector<std::string> all;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string& line = file.lines[i];
        if (std::ranges::none_of(signs, [&](const std::string& sign) { return line.find(sign) != std::string::npos; }))
            continue;
        std::vector<std::string> wrong;
        const std::string more = i + 1 < file.lines.size() ? without_marks(file.path, file.lines[i + 1]) : "";
        judge_line(file.path, line, more, wrong);
        for (const std::string& what : wrong) all.push_back(file.path + ":" + std::to_string(i + 1) + ": " + what);
    }
    return all;
}

}  // namespace

TEST_CASE("cited files and sections exist", "[contract]") {
    std::vector<ProjectFile> files = skerry::test::project_files();
    const std::vector<ProjectFile> texts = skerry::test::project_texts();
    files.insert(files.end(), texts.begin(), texts.end());
    for (const ProjectFile& file : files)
        for (const std::string& objection : objections(file)) {
            INFO(objection);
            CHECK(false);
        }
}

TEST_CASE("the test of citations finds planted faults", "[contract]") {
    const auto found = [](const std::string& path, const std::vector<std::string>& lines) {
        return objections({path, lines}).size();
    };
    const std::string page = "docs/methods/friction", md = ".md";  // apart, so that this file has no wrong citation
    CHECK(found("systems/a.h", {"// As " + page + md + " 2.1 has it."}) == 0);
    CHECK(found("systems/a.h", {"// As " + page + md + " 2.1 and 2.2, 3"}) == 0);
    CHECK(found("systems/a.h", {"// As " + page + md + " 2.77 has it."}) == 1);
    CHECK(found("systems/a.h", {"// As " + page + md + " 1 to 3, 99"}) == 1);
    CHECK(found("systems/a.h", {"    /// As " + page + md, "    /// 2.77 has it."}) == 1);
    CHECK(found("scripts/a", {"# As " + page + md, "# 2.1 has it."}) == 0);
    CHECK(found("systems/a.h", {"// As " + page + "s" + md + " has it."}) == 1);
    CHECK(found("systems/a.h", {"// As methods" + md + " 2.1 has it."}) == 1);
    CHECK(found("tests/a.cpp", {"open(\"../sha" + std::string("red/data\");")}) == 1);
    CHECK(found("tests/a.cpp", {"root / \"..\"" + std::string(" / \"data\"")}) == 1);
    CHECK(found("systems/a.h", {"// Why: decision" + std::string(" 9999.")}) == 1);
    CHECK(found("docs/methods/errors.md", {"[friction](friction" + md + ") 2.1"}) == 0);
    CHECK(found("docs/methods/errors.md", {"[friction](friction" + md + ") 2.77"}) == 1);
    CHECK(found("docs/methods/errors.md", {"![x](figures/no.p" + std::string("ng)")}) == 1);
    CHECK(found("README.md", {"![x](docs/skittles.png)"}) == 0);
}

}  // namespace skerry::test::citations_test
