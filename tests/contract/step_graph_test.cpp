// The drawings of the step graph in docs/ match the step.
#include <skerry/world.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

namespace skerry::test::step_graph_test {

TEST_CASE("the step graph equals its drawing in docs", "[contract]") {
    const std::string path = std::string(SKERRY_SOURCE_DIR) + "/docs/step_graph.dot";
    const std::string now = skerry::World().step_graph();
    if (std::getenv("SKERRY_UPDATE")) std::ofstream(path) << now;

    std::ifstream file(path);
    std::stringstream drawn;
    drawn << file.rdbuf();
    INFO("To write " << path << " anew: SKERRY_UPDATE=1 scripts/test -R 'step graph'");
    CHECK(drawn.str() == now);
}

TEST_CASE("the picture of the step graph shows every stage", "[contract]") {
    std::ifstream file(std::string(SKERRY_SOURCE_DIR) + "/docs/figures/step_graph.svg");
    std::stringstream picture;
    picture << file.rdbuf();
    INFO("To draw it anew: dot -Tsvg docs/step_graph.dot -o docs/figures/step_graph.svg");
    const std::string dot = skerry::World().step_graph();
    static const std::regex stage("^    \"([a-z]+/[a-z_]+)\";$", std::regex::multiline);
    int stages = 0;
    for (std::sregex_iterator found(dot.begin(), dot.end(), stage), end; found != end; ++found, ++stages)
        CHECK(picture.str().find(">" + (*found)[1].str() + "</text>") != std::string::npos);
    CHECK(stages > 40);
}

}  // namespace skerry::test::step_graph_test
