#include "systems/dynamics/elements/find_unstrained.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"

namespace skerry::test::find_unstrained_test {

namespace {

/// One body in free flight.
struct Flight : ElasticBody {
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::vector<Range> body_nodes{{0, static_cast<Index>(position.size())}}, body_blocks{blocks};
    std::vector<std::uint8_t> asleep{0};
    std::vector<std::uint16_t> unstrained{0};

    explicit Flight(ElementKind kind = ElementKind::linear, const Mat3& rotation = Mat3::Identity())
        : ElasticBody(jittered_box({5, 3, 3}, 0.1, 0.3, 3),
                      MaterialConstants{MaterialModel::corotational, 4e4, 6e4, 1000}, rotation, kind) {
        for (Vec3& x : position) x += Vec3(3, -2, 1);
        for (Vec3& v : velocity) v = {1, 2, 3};
    }
    bool find() {
        const UnstrainedInputs inputs{.elements = this->inputs(),
                                      .body_nodes = body_nodes,
                                      .body_blocks = body_blocks,
                                      .body_idle = asleep,
                                      .position = position,
                                      .velocity = velocity,
                                      .rotation = elements.rotation};
        const Index found = find_unstrained(*executor, inputs,
                                            {.unstrained = unstrained,
                                             .rotation_next = elements.rotation_next,
                                             .spring_strain_next = elements.spring_strain_next});
        CHECK(found == (unstrained[0] > 0));
        return found > 0;
    }
};

}  // namespace

TEST_CASE("a body as it was made whose nodes move alike is unstrained", "[unit]") {
    const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const ElementKind kind : element_kinds) {
        Flight body(kind, turn);
        CHECK(body.find());
        CHECK(body.unstrained[0] == unstrained_steps);
        CHECK(body.find());
        CHECK(body.unstrained[0] == unstrained_steps - 1);
    }
}

TEST_CASE("one node that moves otherwise by the last bit ends it", "[unit]") {
    Flight body;
    REQUIRE(body.find());
    for (std::size_t node = 0; node < body.position.size(); ++node)
        for (Real& x : body.velocity[node]) {
            const Real before = x;
            x = std::nextafter(x, 9);
            CHECK_FALSE(body.find());
            x = std::numeric_limits<Real>::quiet_NaN();
            CHECK_FALSE(body.find());
            x = before;
            CHECK(body.find());
        }
}

TEST_CASE("a strained, rotated, mirrored or NaN body is not unstrained", "[unit]") {
    Flight body;
    SECTION("one node a little away") {
        body.position[20].y() += 1e-10;
    }
    SECTION("one node nowhere") {
        body.position[20].y() = std::numeric_limits<Real>::quiet_NaN();
    }
    SECTION("turned") {
        const Mat3 turn = Eigen::AngleAxis<Real>(1e-9, Vec3::UnitZ()).toRotationMatrix();
        for (Vec3& x : body.position) x = turn * x;
    }
    SECTION("mirrored") {
        for (Vec3& x : body.position) x.x() = -x.x();
    }
    SECTION("an element remembers a strain") {
        body.elements.spring_strain[1][6].lane[0] = 1e-30F;
    }
    SECTION("at rest") {
        body.asleep[0] = 1;
    }
    SECTION("without elements") {
        body.body_blocks[0] = {0, 0};
    }
    CHECK_FALSE(body.find());
}

TEST_CASE("bodies taken to be unstrained are finally tested again", "[unit]") {
    Flight body;
    REQUIRE(body.find());
    body.position[20].y() += 1e-3;  // this change is not announced
    for (int step = 1; step < unstrained_steps; ++step) CHECK(body.find());
    CHECK_FALSE(body.find());
}

TEST_CASE("elements of a body that becomes unstrained keep their state for the next step", "[unit]") {
    Flight body;
    for (ElementRotation& rotation : body.elements.rotation_next) rotation = {};
    for (SpringStrain& strain : body.elements.spring_strain_next) strain[0].lane[0] = 1;
    REQUIRE(body.find());
    for (std::size_t b = 0; b < body.elements.first.size(); ++b) {
        for (std::size_t i = 0; i < body.elements.rotation[b].size(); ++i)
            CHECK(std::ranges::equal(body.elements.rotation_next[b][i].lane, body.elements.rotation[b][i].lane));
        if (!body.elements.spring_strain_next.empty()) CHECK(body.elements.spring_strain_next[b][0].lane[0] == 0);
    }
}

}  // namespace skerry::test::find_unstrained_test
