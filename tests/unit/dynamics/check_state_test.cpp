#include "systems/dynamics/checks/check_state.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/support/elastic_body.h"

namespace skerry::test::check_state_test {

namespace {

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN();
constexpr Real unbounded = std::numeric_limits<Real>::infinity();

/// Two bodies of 300 nodes in two blocks each, with one tetrahedron for every four consecutive nodes.
struct State {
    std::vector<Index> begin{0, 256, 300, 556}, end{256, 300, 556, 600}, body{0, 0, 1, 1};
    std::vector<Range> node_blocks{{0, 2}, {2, 4}}, element_blocks{{0, 10}, {10, 20}};
    std::vector<Real> altitude{0.1, 0.1};
    std::vector<Vec3> rest{600, Vec3::Zero()}, velocity{600, Vec3::Zero()}, next{600, Vec3(1, 0, 0)},
        push{600, Vec3::Zero()};
    std::vector<TetrahedronNodes> elements;
    std::vector<ElementLane> element_altitude;
    std::vector<Real> block_speed = std::vector<Real>(4), body_speed = std::vector<Real>(2);
    std::vector<Real> block_frame_speed = block_speed, body_frame_speed = body_speed;
    std::vector<MovingFrame> frame = std::vector<MovingFrame>(2);
    Column<std::uint8_t> beside_fast;
    bool with_elements = true;

    State() {
        for (Index b = 0; b < 20; ++b) {
            TetrahedronNodes nodes;
            for (Index l = 0; l < 8; ++l)
                for (Index a = 0; a < 4; ++a)
                    nodes[static_cast<std::size_t>(a)][static_cast<std::size_t>(l)] =
                        (b / 10) * 300 + std::min((b % 10) * 32 + 4 * l + a, 299);
            elements.push_back(nodes);
            element_altitude.emplace_back();
            for (Real& of_lane : element_altitude.back().lane) of_lane = 0.1;
        }
        for (std::size_t first = 0; first < 600; first += 4) put_corner(first, 0.1);
    }
    /// Gives tetrahedron corners three orthogonal edges of length `edge` [m].
    void put_corner(std::size_t first, Real edge) {
        for (std::size_t a = 1; a < 4; ++a)
            rest[first + a] = rest[first] + edge * Vec3::Unit(static_cast<Index>(a) - 1);
    }
    StepVerdict check(int workers = 1) {
        const auto executor = make_executor(workers == 1 ? Backend::serial : available_backends().front(), workers);
        CheckInputs inputs{begin, end, body, node_blocks, altitude, velocity, next, push};
        if (with_elements) {
            inputs.rest_position = rest;
            inputs.tetrahedron_node = elements;
            inputs.tetrahedron_altitude = element_altitude;
            inputs.body_blocks = element_blocks;
        }
        inputs.body_frame = frame;
        return check_state(*executor, inputs, 0.01, 0.01, 0.2,
                           {block_speed, block_frame_speed, body_speed, body_frame_speed}, beside_fast);
    }
};

}  // namespace

TEST_CASE("a sound step has no fault and its speeds are written", "[unit]") {
    State state;
    state.next[280] = Vec3(0, 1.5, 0);
    state.push[400] = Vec3(0.5, 0, 0);
    CHECK(state.check().fault == StepFault::none);
    CHECK(state.block_speed[0] == 1);
    CHECK(state.block_speed[1] == 2.25);
    CHECK(state.body_speed[0] == 1.5);
    CHECK(state.body_speed[1] == 1.5);  // includes the push-out velocity
}

TEST_CASE("speeds in a frame are those of nodes less its own", "[unit]") {
    State state;
    state.next[280] = Vec3(1, 1.5, 0);
    state.push[400] = Vec3(0.5, 0, 0);
    state.frame[0].velocity = state.frame[1].velocity = Vec3(1, 0, 0);
    CHECK(state.check().fault == StepFault::none);
    CHECK(state.body_frame_speed[0] == 1.5);
    CHECK(state.body_frame_speed[1] == 0.5);
    CHECK(state.body_speed[0] == Approx(std::sqrt(3.25)));
}

TEST_CASE("values that are not finite are found, in the first body first", "[unit]") {
    for (Real bad : {not_a_number, unbounded, -unbounded, 1e200}) {
        State state;
        state.next[570].y() = bad;
        state.next[270].z() = bad;
        const StepVerdict verdict = state.check();
        CHECK(verdict.fault == StepFault::not_finite);
        CHECK(verdict.body == 0);
        CHECK(verdict.node == 270);
        CHECK(std::isnan(state.block_speed[1]));
        CHECK(std::isnan(state.body_speed[1]));  // later speeds are written even after a NaN
        CHECK(state.block_speed[0] == 1);
    }
}

TEST_CASE("a push-out that is not a number is found", "[unit]") {
    State state;
    state.push[599].x() = not_a_number;
    const StepVerdict verdict = state.check();
    CHECK(verdict.fault == StepFault::not_finite);
    CHECK(verdict.node == 599);
}

TEST_CASE("a kinematic body is not judged by its speed, but must be finite", "[unit]") {
    State state;
    state.altitude[0] = 0;
    state.next[5] = Vec3(1e6, 0, 0);
    CHECK(state.check().fault == StepFault::none);
    state.next[5].x() = not_a_number;
    CHECK(state.check().fault == StepFault::not_finite);
}

TEST_CASE("corners that part by more than the limit are too fast, by just less they are not", "[unit]") {
    // Limit: 0.2 * 0.1 m in 0.01 s: 2 m/s.
    for (bool with_elements : {true, false}) {
        State state;
        state.with_elements = with_elements;
        state.next[402] = Vec3(1, 1.9, 0);
        CHECK(state.check().fault == StepFault::none);
        state.next[402] = Vec3(1, 2.1, 0);
        const StepVerdict verdict = state.check();
        CHECK(verdict.fault == StepFault::too_fast);
        CHECK(verdict.body == 1);
        CHECK(verdict.node == 402);
        CHECK(verdict.tetrahedron == (with_elements ? 105 : no_index));  // nodes 400 to 403: lane 1 of block 13
        CHECK(verdict.value == Approx(0.21).epsilon(0.01));              // 1 %: the mean moves with the node
    }
}

TEST_CASE("each element is judged by its own altitude, and not by that of a sliver elsewhere", "[unit]") {
    State state;
    state.altitude = {0.001, 0.001};
    state.element_altitude[2][3] = 0.001;  // nodes 76 to 79
    state.put_corner(76, 0.001);
    state.next[402] = Vec3(1, 1.9, 0);
    CHECK(state.check().fault == StepFault::none);
    state.next[78] = Vec3(1, 0.021, 0);
    const StepVerdict verdict = state.check();
    CHECK(verdict.fault == StepFault::too_fast);
    CHECK(verdict.node == 78);
    CHECK(verdict.tetrahedron == 19);
    CHECK(verdict.value == Approx(0.21));
}

TEST_CASE("corners of a sliver that slide along its flat side strain nothing", "[unit]") {
    State state;
    state.altitude[0] = 0.001;
    state.element_altitude[2][3] = 0.001;  // nodes 76 to 79: three corners in a plane, one a millimetre above it
    state.rest[79] = state.rest[76] + Vec3(0.03, 0.03, 0.001);
    for (std::size_t n = 76; n < 80; ++n) state.next[n] = Vec3(1 + 5 * (state.rest[n] - state.rest[76]).y(), 0, 0);
    CHECK(state.check().fault == StepFault::none);
    state.next[79].z() = 0.03;  // 3e-4 m per step
    const StepVerdict verdict = state.check();
    CHECK(verdict.fault == StepFault::too_fast);
    CHECK(verdict.tetrahedron == 19);
    CHECK(verdict.value == Approx(0.3).epsilon(0.05));
}

TEST_CASE("common motion does no harm, however fast", "[unit]") {
    for (bool with_elements : {true, false}) {
        State state;
        state.with_elements = with_elements;
        for (Vec3& v : state.next) v = Vec3(1000, 0, 0);
        CHECK(state.check().fault == StepFault::none);
        CHECK(state.body_speed[0] == 1000);
    }
}

TEST_CASE("a turn that is slow for each element is allowed to a large body", "[unit]") {
    State state;
    // 30 m/s at the far end
    for (std::size_t n = 0; n < 600; ++n) state.next[n] = Vec3(0, 0.1 * static_cast<Real>(n), 0);
    CHECK(state.check().fault == StepFault::none);
}

TEST_CASE("the verdict is the same on any number of workers", "[unit][determinism]") {
    for (int workers : {1, 2, 3, 4, 8}) {
        State state;
        state.next[100] = state.next[200] = state.next[301] = Vec3(1, 30, 0);
        const StepVerdict verdict = state.check(workers);
        CHECK(verdict.fault == StepFault::too_fast);
        CHECK(verdict.body == 0);
        CHECK(verdict.node == 101);  // a corner of the first of the equally fast elements; its base is node 100
    }
}

TEST_CASE("a world without bodies and a body without nodes are sound", "[unit]") {
    Column<std::uint8_t> beside_fast;
    const auto executor = make_executor(Backend::serial, 1);
    CHECK(check_state(*executor, {}, 0.01, 0.01, 0.2, {}, beside_fast).fault == StepFault::none);
    const std::vector<Range> none{{0, 0}};
    const std::vector<Real> altitude{0.1};
    std::vector<Real> speed(1, 7), frame_speed(1, 7);
    CheckInputs inputs;
    inputs.body_node_blocks = none;
    inputs.body_min_altitude = altitude;
    CHECK(check_state(*executor, inputs, 0.01, 0.01, 0.2, {{}, {}, speed, frame_speed}, beside_fast).fault ==
          StepFault::none);
    CHECK(speed[0] == 0);
    CHECK(frame_speed[0] == 0);
}

namespace {

/// A box with randomly moving nodes, so that tetrahedra deform faster than their averages in smoothed elements.
struct TrembleState {
    test::ElasticBody body;
    std::vector<Index> begin{0}, end, of_body{0};
    std::vector<Range> node_blocks{{0, 1}}, tetrahedron_blocks, element_blocks;
    std::vector<Real> altitude{0.01}, speed = std::vector<Real>(1), block_speed = std::vector<Real>(1);
    std::vector<Real> frame_speed = speed, block_frame_speed = block_speed;
    std::vector<Vec3> rest;
    Column<std::uint8_t> beside_fast;

    explicit TrembleState(ElementKind kind)
        : body(test::jittered_box({4, 3, 3}, 0.1, 0.1, 1), material_constants(MaterialModel::linear, 1e5, 0.3, 1000),
               Mat3::Identity(), kind),
          end{static_cast<Index>(body.position.size())},
          tetrahedron_blocks{{0, static_cast<Index>(body.tetrahedra.node.size())}},
          element_blocks{body.blocks},
          rest(body.position) {
        std::mt19937_64 random(2);
        for (Vec3& v : body.velocity) v = test::random_vector(random);
        body.position = body.velocity;  // so that deformation() returns F'
    }
    Real rate_of(std::size_t element) const { return body.deformation(element).norm(); }
    /// Largest deformation rate of an element [1/s], and that element.
    std::pair<Real, std::size_t> fastest() const {
        std::pair<Real, std::size_t> found{0, 0};
        for (std::size_t e = 0; e < element_lanes * body.elements.first.size(); ++e)
            if (body.volume(e) > 0) found = std::max(found, std::pair(rate_of(e), e));
        return found;
    }
    /// Largest deformation rate of a tetrahedron [1/s]: |F'|, limited by the corners' relative speed over the altitude.
    Real fastest_tetrahedron() const {
        Real highest = 0;
        for (std::size_t t = 0; t < element_lanes * body.tetrahedra.node.size(); ++t) {
            const TetrahedronNodes& nodes = body.tetrahedra.node[t / element_lanes];
            const auto node = [&](std::size_t a) { return static_cast<std::size_t>(nodes[a][t % element_lanes]); };
            Mat3 edge, parting;
            for (std::size_t a = 1; a < 4; ++a) {
                edge.col(static_cast<Index>(a) - 1) = rest[node(a)] - rest[node(0)];
                parting.col(static_cast<Index>(a) - 1) = body.velocity[node(a)] - body.velocity[node(0)];
            }
            if (!(edge.determinant() > 0)) continue;  // unused lane
            const Real by_corners =
                parting.colwise().norm().maxCoeff() / body.tetrahedra.altitude[t / element_lanes][t % element_lanes];
            highest = std::max(highest, std::min(by_corners, (parting * edge.inverse()).norm()));
        }
        return highest;
    }
    /// Checks a step of 1 s if steps up to `longest` are considered [s].
    StepVerdict check(Real rate, Real longest = 1) {
        const auto executor = make_executor(Backend::serial, 1);
        CheckInputs inputs{begin, end, of_body, node_blocks, altitude, body.velocity, body.velocity, {}};
        inputs.rest_position = rest;
        inputs.tetrahedron_node = body.tetrahedra.node;
        inputs.tetrahedron_altitude = body.tetrahedra.altitude;
        inputs.tetrahedron_leeway = body.tetrahedra.leeway;
        inputs.body_blocks = tetrahedron_blocks;
        inputs.body_element_blocks = element_blocks;
        inputs.element_first = body.elements.first;
        inputs.element_count = body.elements.count;
        inputs.element_node = body.element_nodes.node;
        inputs.element_gradient = body.element_nodes.gradient;
        inputs.element_implicit_modulus = body.elements.implicit_modulus;
        return check_state(*executor, inputs, 1, longest, rate, {block_speed, block_frame_speed, speed, frame_speed},
                           beside_fast);
    }
};

}  // namespace

TEST_CASE("an element that deforms too fast is found, and the report names the fastest tetrahedron", "[unit]") {
    TrembleState tetrahedra(ElementKind::linear), edges(ElementKind::edge_smoothed);
    const auto [of_tetrahedra, fastest] = tetrahedra.fastest();
    const Real of_edges = edges.fastest().first;
    REQUIRE(of_edges < 0.9 * of_tetrahedra);
    CHECK(tetrahedra.check(1.01 * of_tetrahedra).fault == StepFault::none);
    const StepVerdict too_fast = tetrahedra.check(0.5 * of_tetrahedra);
    CHECK(too_fast.fault == StepFault::too_fast);
    CHECK(too_fast.value == Approx(of_tetrahedra));
    CHECK(edges.check(1.01 * of_edges).fault == StepFault::none);  // although tetrahedra are faster
    const StepVerdict of_smoothed = edges.check(0.5 * of_edges);
    CHECK(of_smoothed.fault == StepFault::too_fast);
    CHECK(of_smoothed.value == Approx(of_tetrahedra));
    CHECK(of_smoothed.tetrahedron == too_fast.tetrahedron);
}

TEST_CASE("an implicit element may deform five times as fast", "[unit]") {
    TrembleState state(ElementKind::edge_smoothed);
    for (ElementLane& of : state.body.tetrahedra.leeway) of = {{5, 5, 5, 5, 5, 5, 5, 5}};
    const auto [rate, fastest] = state.fastest();
    CHECK(state.check(0.3 * rate).fault == StepFault::none);  // no tetrahedron is too fast: elements are not tested
    for (ElementLane& of : state.body.tetrahedra.leeway) of = {{1, 1, 1, 1, 1, 1, 1, 1}};
    REQUIRE(state.check(0.99 * rate).fault == StepFault::too_fast);
    state.body.elements.implicit_modulus[fastest / element_lanes][fastest % element_lanes] = 1;
    CHECK(state.check(0.99 * rate).fault == StepFault::none);
    for (ElementLane& of : state.body.elements.implicit_modulus) of = {{1, 1, 1, 1, 1, 1, 1, 1}};
    CHECK(state.check(0.21 * rate).fault == StepFault::none);
    CHECK(state.check(0.19 * rate).fault == StepFault::too_fast);
}

TEST_CASE("how fast the fastest element deforms is said where it would be too fast for a longer step", "[unit]") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::edge_smoothed}) {
        TrembleState state(kind);
        const Real rate = std::min(state.fastest_tetrahedron(), state.fastest().first);
        const StepVerdict sound = state.check(1.5 * rate, 2);  // steps of 2 s would be too long
        CHECK(sound.fault == StepFault::none);
        CHECK(sound.fastest.body == 0);
        CHECK(sound.fastest.rate == Approx(rate));
        CHECK(state.check(2.5 * rate, 2).fastest.body == no_index);
        CHECK(state.check(0.5 * rate, 1).fastest.rate == Approx(rate));
    }
}

}  // namespace skerry::test::check_state_test
