// The drawing of the step graph in docs/ matches the step.
#include <skerry/world.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
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

}  // namespace skerry::test::step_graph_test
