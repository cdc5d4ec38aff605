// docs/why.md explains every warning of the program and every message of a step.
#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <string>
#include <vector>

#include "tests/contract/project_files.h"

namespace skerry::test::warnings_test {

namespace {

/// A part of a source file with messages: from the line that contains `begin` to the next line that is "}". Without
/// `begin`: the whole file.
struct Source {
    std::string path, begin;
};

const std::vector<Source> sources{{"engine/program/warnings.cpp", ""},
                                  {"engine/program/plan_warnings.cpp", ""},
                                  {"engine/program/start_text.h", "into_shell_text("},
                                  {"engine/program/start_text.h", "turning_text("},
                                  {"engine/program/contact_area_text.cpp", ""},
                                  {"engine/program/thin_part_text.cpp", ""},
                                  {"engine/program/stiff_note.cpp", ""},
                                  {"engine/program/mesh_text.cpp", "problems_of("},
                                  {"engine/program/inspect.cpp", "Problems problems_of("},
                                  {"engine/program/run.cpp", "bad_boundaries(const"},
                                  {"engine/mesh/visual/bind_visual.cpp", "std::string warning_of("},
                                  {"engine/world/world_report.cpp", "WorldReport::distrust("},
                                  {"engine/world/world_report.cpp", "StepReport::message("},
                                  {"engine/world/world_report.cpp", "StepReport::warning("},
                                  {"engine/world/step/find_self_crossings.cpp", "SelfCrossing::message("}};

std::string text_of(const Source& source) {
    const std::vector<std::string> lines = project_file(source.path).lines;
    const auto begin =
        std::ranges::find_if(lines, [&](const std::string& line) { return line.find(source.begin) != line.npos; });
    const auto end = source.begin.empty() ? lines.end() : std::find(begin, lines.end(), "}");
    std::string text;
    for (auto line = begin; line != end; ++line) text += *line + "\n";
    return text;
}

/// Messages in a piece of code: the texts of each statement that returns, appends or adds text. Texts between which
/// the code inserts values are separated by "...". Texts of fewer than four words are parts of messages.
std::vector<std::string> messages_of(const std::string& code) {
    static const std::regex text("\"((?:[^\"\\\\\n]|\\\\.)*)\"(\\s*(?=\"))?");
    static const std::regex statement("(?:\"(?:[^\"\\\\\n]|\\\\.)*\"|[^\";])*;");
    static const std::regex gives("push_back\\(|return |text \\+?= ");
    std::vector<std::string> messages;
    for (std::sregex_iterator at(code.begin(), code.end(), statement), end; at != end; ++at) {
        const std::string whole = at->str();
        if (!std::regex_search(whole, gives)) continue;
        std::string message;
        for (std::sregex_iterator t(whole.begin(), whole.end(), text); t != end; ++t)
            message += (*t)[1].str() + ((*t)[2].matched ? "" : "...");
        message = std::regex_replace(message, std::regex("\\\\\""), "\"");
        if (std::ranges::count(message, ' ') >= 4) messages.push_back(message);
    }
    return messages;
}

/// Texts in backquotes before the first colon outside of them in the list items of a page.
std::vector<std::string> quoted_in(const ProjectFile& page) {
    static const std::regex quoted("`([^`]*)`");
    std::vector<std::string> texts;
    for (const std::string& line : page.lines) {
        if (!line.starts_with("- `")) continue;
        const std::string head = line.substr(0, line.find("`: ") + 1);
        for (std::sregex_iterator at(head.begin(), head.end(), quoted), end; at != end; ++at) texts.push_back((*at)[1]);
    }
    return texts;
}

}  // namespace

TEST_CASE("the docs explain every warning, and only warnings that exist", "[contract]") {
    const std::vector<std::string> explained = quoted_in(project_file("docs/why.md"));
    std::vector<std::string> messages;
    for (const Source& source : sources) {
        const std::vector<std::string> found = messages_of(text_of(source));
        INFO(source.path << " " << source.begin);
        CHECK_FALSE(found.empty());
        messages.insert(messages.end(), found.begin(), found.end());
    }
    const auto contains = [](const std::string& message, const std::string& part) {
        return message.find(part) != std::string::npos;
    };
    for (const std::string& message : messages) {
        INFO("docs/why.md quotes no part of this message: " << message);
        CHECK(std::ranges::any_of(explained, [&](const std::string& part) { return contains(message, part); }));
    }
    for (const std::string& part : explained) {
        INFO("no message contains this text of docs/why.md: " << part);
        CHECK(std::ranges::any_of(messages, [&](const std::string& message) { return contains(message, part); }));
    }
}

}  // namespace skerry::test::warnings_test
