// The main function of all test programs: that of Catch2, plus `--list-cases` for cmake/discover_tests.cmake.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstring>
#include <iostream>

namespace {

/// Prints one line for each test case that is not hidden: its source file, name and tags, separated by tabs.
void list_cases(Catch::Session& session) {
    for (const Catch::TestCase& test : Catch::getAllTestCasesSorted(session.config())) {
        if (test.isHidden()) continue;
        std::cout << test.lineInfo.file << '\t' << test.name;
        for (const std::string& tag : test.tags) std::cout << '\t' << tag;
        std::cout << '\n';
    }
}

}  // namespace

int main(int argument_count, char* arguments[]) {
    Catch::Session session;
    if (argument_count == 2 && std::strcmp(arguments[1], "--list-cases") == 0) {
        list_cases(session);
        return 0;
    }
    return session.run(argument_count, arguments);
}
