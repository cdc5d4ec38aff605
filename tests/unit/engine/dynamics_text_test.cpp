// Summary of the choices between explicit and implicit dynamics.
#include <catch2/catch.hpp>

#include "engine/program/dynamics_text.h"

namespace skerry::test::dynamics_text_test {

namespace {

DynamicsChoice choice(BodyDynamics dynamics, DynamicsReason reason, Real explicit_cost, Real implicit_cost,
                      Real strain = 0) {
    DynamicsChoice made{.body = {}, .name = "body", .dynamics = dynamics, .estimate = {}};
    made.estimate.reason = reason;
    made.estimate.explicit_cost = explicit_cost;
    made.estimate.implicit_cost = implicit_cost;
    made.estimate.strain = strain;
    return made;
}

}  // namespace

TEST_CASE("one line names all choices of dynamics and their reasons", "[unit]") {
    constexpr auto is_explicit = BodyDynamics::explicit_elastic, is_implicit = BodyDynamics::implicit_elastic;
    WorldReport report;
    CHECK(choices_text(report).empty());
    report.dynamics_choices.push_back(choice(is_implicit, DynamicsReason::cost, 5, 1));
    CHECK(choices_text(report) == "1 body: 1 implicit (stiff: explicit steps would cost 5 times as much)");
    report.dynamics_choices.push_back(choice(is_implicit, DynamicsReason::cost, 2.5, 0.5));
    report.dynamics_choices.push_back(choice(is_explicit, DynamicsReason::cost, 2, 3));
    report.dynamics_choices.push_back(choice(is_explicit, DynamicsReason::strain, 0, 0, 0.3));
    report.dynamics_choices.push_back(choice(is_explicit, DynamicsReason::strain, 0, 0, 0.4));
    report.dynamics_choices.push_back(choice(is_explicit, DynamicsReason::self_contact, 0, 0));
    CHECK(
        choices_text(report) ==
        "6 bodies: 1 explicit (self-contact), 2 explicit (soft: strains of up to 40 % expected), 1 explicit "
        "(implicit steps would cost 1.5 times as much), 2 implicit (stiff: explicit steps would cost 5 times as much)");
    report.dynamics_choices.assign(1, choice(is_implicit, DynamicsReason::cost, 4321, 1));
    CHECK(choices_text(report) == "1 body: 1 implicit (stiff: explicit steps would cost 4,321 times as much)");
}

}  // namespace skerry::test::dynamics_text_test
