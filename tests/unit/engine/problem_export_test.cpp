// Contact problems of steps: a world exports the problem that it solved.
#include <skerry/world.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "problem_samples.h"
#include "skerry/cable.h"
#include "skerry/joint.h"
#include "skerry/problem.h"
#include "skerry/tie.h"
#include "systems/contact/tangent_frame.h"

namespace skerry::test::problem_export_test {

namespace {

/// Two small blocks, stacked askew on a plane and dropped: regions of several contacts, sliding and sticking.
struct Stack {
    World world;
    std::vector<StepProblem> problems;
    std::vector<std::vector<Contact>> contacts;

    explicit Stack(Settings settings = exact(),
                   const MaterialSettings& material = {.young_modulus = 2e4, .density = 500},
                   BodyDynamics dynamics = BodyDynamics::explicit_elastic)
        : world(settings) {
        const auto rubber = world.add_material(material);
        world.add_collider(Plane{});
        const Mesh block = mesh::box({0.2, 0.2, 0.1}, {2, 2, 1});
        world.add_body(block, {.material = rubber,
                               .position = {0, 0, 0.055},
                               .velocity = {0.3, 0, -0.5},
                               .contact_distance = 0.002,
                               .dynamics = dynamics});
        world.add_body(block, {.material = rubber,
                               .position = {0.03, 0.02, 0.165},
                               .rotation = {0, 0, 0.3},
                               .velocity = {-0.2, 0.1, -1},
                               .contact_distance = 0.002,
                               .dynamics = dynamics});
    }
    static Settings exact() {
        Settings settings;
        settings.tolerance = 1e-11;
        settings.max_iterations = 20000;
        return settings;
    }
    void watch(std::uint64_t every = 1) {
        world.watch_contact_problems(
            [this](const StepProblem& problem) {
                problems.push_back(problem);
                contacts.emplace_back(world.contacts().begin(), world.contacts().end());
            },
            every);
    }
    bool any_coupled() const {
        for (const StepProblem& step : problems)
            if (step.problem.column.size() > step.problem.q.size()) return true;
        return false;
    }
};

Real largest(const std::vector<Vec3>& vectors) {
    Real size = 0;
    for (const Vec3& v : vectors) size = std::max(size, v.norm());
    return size;
}

Real distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    REQUIRE(a.size() == b.size());
    Real size = 0;
    for (std::size_t i = 0; i < a.size(); ++i) size = std::max(size, (a[i] - b[i]).norm());
    return size;
}

}  // namespace

TEST_CASE("the impulses of a step solve the problem that it shows", "[unit][problem]") {
    Stack stack;
    stack.watch();
    stack.world.advance(0.14);
    REQUIRE(stack.problems.size() > 20);
    REQUIRE(stack.any_coupled());
    int turns = 0;
    for (std::size_t k = 0; k < stack.problems.size(); ++k) {
        const StepProblem& step = stack.problems[k];
        INFO("step " << step.step << ", " << step.problem.contacts() << " contacts");
        // The solver's tolerance of 1e-11 is in its own error measure, which weights contacts by their masses. Three
        // digits allow for the difference.
        CHECK(independent_error(step.problem, step.impulse) < 1e-8);
        const std::vector<Vec3> u = velocities(step.problem, step.impulse);
        for (std::size_t i = 0; i < u.size(); ++i) {
            // the same contact as the world reports it, in its own frame
            const Contact& contact = stack.contacts[k][step.contact[i]];
            const TangentFrame tangents = tangent_frame(contact.normal);
            const Vec3 frame[] = {contact.normal, tangents.first, tangents.second};
            for (int axis = 0; axis < 3; ++axis) CHECK(step.impulse[i][axis] == contact.impulse.dot(frame[axis]));
            for (int axis = 1; axis < 3; ++axis) {
                // Nothing else moves here: tangentially the offset is the half turn of the midpoint slip.
                const Real turned = step.lumped.offset[i].dot(frame[axis]);
                CHECK(u[i][axis] == Approx(contact.slip.dot(frame[axis]) + turned).margin(1e-12));  // [m/s]
                turns += turned != 0;
            }
            CHECK(step.region[i] == contact.region);
            CHECK(step.problem.mu[i] == 0.5);
        }
    }
    CHECK(turns > 10);
}

TEST_CASE("the impulses of a step of rigid or implicit bodies solve the problem that it shows",
          "[unit][problem][long]") {
    const auto dynamics = GENERATE(BodyDynamics::rigid, BodyDynamics::implicit_elastic);
    const auto modulus = GENERATE(1e6, 1e9);
    Settings settings = Stack::exact();
    settings.step_size = 2e-3;
    Stack stack(settings, {.young_modulus = modulus, .density = 500}, dynamics);
    stack.watch();
    stack.world.advance(0.2);
    REQUIRE(stack.problems.size() > 20);
    REQUIRE(stack.any_coupled());
    for (const StepProblem& step : stack.problems) {
        INFO("step " << step.step << ", " << step.problem.contacts() << " contacts");
        CHECK(step.lumped.strained.empty() == (dynamics == BodyDynamics::rigid));
        // The error measures differ, and W is nearly singular: many contacts on six degrees of freedom.
        CHECK(independent_error(step.problem, step.impulse) < 1e-6);
    }
}

TEST_CASE("the impulses of a step of a held implicit body solve the problem that it shows", "[unit][problem]") {
    Settings settings = Stack::exact();
    settings.step_size = 2e-3;
    Stack stack(settings, {.young_modulus = 1e6, .density = 500}, BodyDynamics::implicit_elastic);
    stack.world.attach(stack.world.bodies()[0], std::vector<Index>{0, 1, 2, 3});
    stack.watch();
    stack.world.advance(0.2);
    REQUIRE(stack.problems.size() > 20);
    REQUIRE(stack.any_coupled());
    for (const StepProblem& step : stack.problems) CHECK(independent_error(step.problem, step.impulse) < 1e-6);
}

TEST_CASE("the impulses of a step of rigid spheres solve the problem that it shows", "[unit][problem][long]") {
    Settings settings = Stack::exact();
    settings.step_size = 2e-3;
    Stack stack(settings, {.young_modulus = 1e6, .density = 500}, BodyDynamics::rigid);
    const auto rubber = stack.world.add_material({.density = 500, .friction = 0.5});
    for (const Vec3& place : {Vec3(0.3, 0, 0.101), Vec3(0.42, 0.1, 0.24), Vec3(0, 0, 0.32)})
        stack.world.add_body(Sphere{0.1}, {.material = rubber,
                                           .position = place,
                                           .velocity = {-0.5, 0, -0.5},
                                           .angular_velocity = {3, 8, -5},
                                           .contact_distance = 0.002,
                                           .dynamics = BodyDynamics::rigid});
    stack.watch();
    stack.world.advance(0.2);
    REQUIRE(stack.problems.size() > 20);
    REQUIRE(stack.any_coupled());
    for (std::size_t k = 0; k < stack.problems.size(); ++k) {
        const StepProblem& step = stack.problems[k];
        CHECK(independent_error(step.problem, step.impulse) < 1e-6);
        const std::vector<Vec3> u = velocities(step.problem, step.impulse);
        for (std::size_t i = 0; i < u.size(); ++i) {  // slip includes the spins
            const Contact& contact = stack.contacts[k][step.contact[i]];
            const TangentFrame tangents = tangent_frame(contact.normal);
            for (const auto& [axis, along] : {std::pair{1, tangents.first}, {2, tangents.second}})
                if (step.lumped.friction[i] > 0 && contact.motion == ContactMotion::stick)
                    CHECK(u[i][axis] == Approx(contact.slip.dot(along)).margin(1e-8));
        }
    }
}

TEST_CASE("the lumped form of a step and its blocks give the same velocities", "[unit][problem]") {
    Stack stack;
    stack.watch(5);
    stack.world.advance(0.1);
    REQUIRE(stack.any_coupled());
    for (const StepProblem& step : stack.problems) {
        const LumpedContacts& lumped = step.lumped;
        std::vector<Vec3> impulse;  // arbitrary impulses in world axes [N s]
        for (std::size_t i = 0; i < lumped.node.size(); ++i) {
            const Real k = static_cast<Real>(i);
            impulse.emplace_back(std::sin(k), std::cos(2 * k), std::sin(3 * k));
        }
        std::vector<Vec3> velocity = lumped.velocity;
        for (std::size_t i = 0; i < impulse.size(); ++i)
            for (std::size_t a = 0; a < 4; ++a) {
                const Index node = lumped.node[i][a];
                velocity[node] += lumped.weight[i][a] * lumped.inverse_mass[node] * impulse[i];
            }
        std::vector<Vec3> relative = lumped.offset;
        for (std::size_t i = 0; i < impulse.size(); ++i)
            for (std::size_t a = 0; a < 4; ++a) relative[i] += lumped.weight[i][a] * velocity[lumped.node[i][a]];
        const std::vector<Vec3> u = velocities(step.problem, in_contact_frames(lumped, impulse));
        CHECK(distance(in_contact_frames(lumped, relative), u) < 1e-12 * largest(u));  // rounding
    }
}

TEST_CASE("a step's problem goes to a file and back, and its solution moves contacts as the step did",
          "[unit][problem]") {
    const TemporaryFolder folder;
    Stack stack;
    stack.watch(7);
    stack.world.advance(0.1);
    REQUIRE(stack.any_coupled());
    for (const StepProblem& step : stack.problems) {
        CHECK(step.step % 7 == 0);
        write_problem(step.problem, folder.path() / "step.hdf5", step.impulse);
        const ContactProblem problem = read_problem(folder.path() / "step.hdf5");
        CHECK(difference(problem, step.problem) == 0);
        const ProblemSolution solution = solve_problem(problem, {.tolerance = 1e-11});
        INFO("step " << step.step << ", " << problem.contacts() << " contacts, error " << solution.error);
        REQUIRE(solution.converged);
        // Velocities are unique, impulses need not be. Both solves leave at most 1e-8 of the largest velocity.
        const std::vector<Vec3> u = velocities(problem, solution.reaction);
        CHECK(distance(u, velocities(problem, step.impulse)) < 1e-6 * (largest(problem.q) + largest(u)));
    }
}

TEST_CASE("regions alone are solved as the whole step is", "[unit][problem]") {
    Stack stack;
    stack.watch(11);
    stack.world.advance(0.1);
    REQUIRE(stack.any_coupled());
    for (const StepProblem& step : stack.problems) {
        std::vector<Vec3> together(step.impulse.size(), Vec3::Zero());
        const Index regions = *std::max_element(step.region.begin(), step.region.end()) + 1;
        for (Index region = 0; region < regions; ++region) {
            std::vector<Index> contacts;
            for (std::size_t i = 0; i < step.region.size(); ++i)
                if (step.region[i] == region) contacts.push_back(static_cast<Index>(i));
            if (contacts.empty()) continue;
            const ProblemSolution part = solve_problem(part_of(step.problem, contacts), {.tolerance = 1e-11});
            CHECK(part.regions >= 1);
            for (std::size_t i = 0; i < contacts.size(); ++i) together[contacts[i]] = part.reaction[i];
        }
        CHECK(independent_error(step.problem, together) < 1e-9);
        // No block couples two regions.
        for (std::size_t i = 0; i < step.region.size(); ++i)
            for (Index k = step.problem.row_offset[i]; k < step.problem.row_offset[i + 1]; ++k)
                CHECK(step.region[step.problem.column[k]] == step.region[i]);
    }
}

TEST_CASE("bounces are part of the problem that a step shows", "[unit][problem]") {
    Stack stack(Stack::exact(), {.young_modulus = 2e4, .density = 500, .restitution = 0.7});
    stack.watch();
    stack.world.advance(0.07);
    REQUIRE(stack.problems.size() > 10);
    for (const StepProblem& step : stack.problems) CHECK(independent_error(step.problem, step.impulse) < 1e-8);
}

TEST_CASE("a problem says when its mu is not all of the friction", "[unit][problem]") {
    const MaterialSettings two{.young_modulus = 2e4, .density = 500, .static_friction = 0.6, .dynamic_friction = 0.3};
    for (const bool same : {true, false}) {
        Stack stack = same ? Stack() : Stack(Stack::exact(), two);
        stack.watch(5);
        stack.world.advance(0.05);
        REQUIRE_FALSE(stack.problems.empty());
        const ContactProblem& problem = stack.problems.back().problem;
        CHECK((problem.description.find("dynamic") != std::string::npos) == !same);
        CHECK(problem.mu[0] == (same ? 0.5 : 0.3));
    }
}

TEST_CASE("watching changes nothing, and not watching costs a skipped stage", "[unit][problem]") {
    Stack watched, alone;
    watched.watch();
    CHECK(watched.world.advance(0.05).ok());
    CHECK(alone.world.advance(0.05).ok());
    CHECK(watched.world.state_hash() == alone.world.state_hash());
    for (const StageReport& stage : alone.world.report().stages)
        if (stage.name == "world/keep_velocities") CHECK(stage.runs == 0);
    const std::size_t shown = watched.problems.size();
    CHECK(shown > 0);
    watched.world.watch_contact_problems({});
    watched.world.advance(0.01);
    CHECK(watched.problems.size() == shown);
    CHECK_THROWS_AS(watched.world.watch_contact_problems([](const StepProblem&) {}, 0), SceneError);
}

TEST_CASE("joints, ties, rollers and cables are eliminated from problems, and the impulses of the step solve them",
          "[unit][problem]") {
    Settings settings = Stack::exact();
    settings.tolerance = 1e-13;
    constexpr BodyDynamics soft = BodyDynamics::explicit_elastic;
    World world(settings);
    const auto rubber = world.add_material({.young_modulus = 2e4, .density = 500});
    world.add_collider(Plane{});
    const Mesh block = mesh::box({0.2, 0.2, 0.1}, {2, 2, 1});
    const auto add = [&](Real x, Real z, BodyDynamics dynamics) {
        return world.add_body(block, {.material = rubber,
                                      .position = {x, 0, z},
                                      .velocity = {0.3, 0, -0.5},
                                      .contact_distance = 0.002,
                                      .dynamics = dynamics});
    };
    constexpr Real low = 0.052, high = 0.155;  // [m]
    const BodyHandle tied = add(1, low, soft), joined = add(2, low, BodyDynamics::rigid),
                     roped = add(3, low, BodyDynamics::rigid), rolled = add(4, low, soft), hung = add(5, low, soft),
                     gripped = add(6, low, BodyDynamics::rigid), padded = add(6, high, soft);
    add(1, high, soft);  // lies on the tied body, so that their regions are one
    Ties ties(world);
    ties.add({.body = tied, .nodes = {0}});
    ties.add({.kind = TieKind::ball, .body = hung, .nodes = {0, 1, 2, 3, 4}});
    const BodyHandle plate =
        world.add_body(mesh::box({0.2, 0.2, 0.02}, {1, 1, 1}),
                       {.material = rubber, .position = {6, 0, high + 0.062}, .dynamics = BodyDynamics::rigid});
    std::vector<Index> upper, all(block.nodes.size());
    for (std::size_t n = 0; n < block.nodes.size(); ++n)
        if (block.nodes[n].z() > 0.049) upper.push_back(static_cast<Index>(n));
    ties.add({.body = padded, .nodes = upper, .to_body = plate});
    std::iota(all.begin(), all.end(), Index{0});
    world.attach(rolled, all, {}, Vec3::Zero(), {Vec3::UnitX()});
    Joints joints(world);
    joints.add({.kind = JointKind::slider, .first = joined, .point = {2, 0, 0}});
    const JointHandle leader = joints.add({.kind = JointKind::hinge,
                                           .first = roped,
                                           .point = {3, 0, 0.052},
                                           .axis = {0, 1, 0},
                                           .motor = JointMotor{.speed = 0.1, .strength = 0.3}});
    joints.set_mimic(joints.add({.kind = JointKind::slider, .first = gripped, .point = {6, 0, 0}}),
                     JointMimic{.leader = leader, .ratio = 0.2});
    Cables(world).add(
        {.points = {{.point = {5, 0, 1}}, {.body = hung, .point = {5, 0, low}}}, .drive = {.length = TimeTable(0.94)}});
    std::size_t contacts = 0;
    Real worst = 0;
    world.watch_contact_problems([&](const StepProblem& step) {
        contacts += step.contact.size();
        // The contacts of the two welded nodes and of the three nodes straight below a hinge cannot move.
        CHECK(step.contact.size() + 5 >= world.contacts().size());
        worst = std::max(worst, problem_error(step.problem, step.impulse).relative);
    });
    REQUIRE(world.advance(0.03).ok());
    CHECK(contacts > 100);
    CHECK(worst < 1e-10);
}

namespace {

/// A soft implicit body that slides on a plane below a rigid plate. A weld connects them, and the plate slides along a
/// vertical joint.
struct Padded {
    World world;
    std::vector<StepProblem> problems;
    Real worst = 0;  // largest relative error of the impulses of a step

    explicit Padded(Real modulus, Real friction = 0.5, bool is_welded = true) : world(settings()) {
        const auto rubber = world.add_material({.young_modulus = modulus, .density = 500, .friction = friction});
        world.add_collider(Plane{});
        const Mesh block = mesh::box({0.2, 0.2, 0.1}, {2, 2, 1});
        const BodyHandle pad = world.add_body(block, {.material = rubber,
                                                      .position = {0, 0, 0.052},
                                                      .velocity = {0.3, 0, -0.5},
                                                      .contact_distance = 0.002,
                                                      .dynamics = BodyDynamics::implicit_elastic});
        if (is_welded) {
            const BodyHandle plate =
                world.add_body(mesh::box({0.2, 0.2, 0.02}, {1, 1, 1}),
                               {.material = rubber, .position = {0, 0, 0.114}, .dynamics = BodyDynamics::rigid});
            std::vector<Index> upper;
            for (std::size_t n = 0; n < block.nodes.size(); ++n)
                if (block.nodes[n].z() > 0.049) upper.push_back(static_cast<Index>(n));
            Ties(world).add({.body = pad, .nodes = upper, .to_body = plate});
            Joints(world).add({.kind = JointKind::slider, .first = plate, .point = {0, 0, 0.114}, .axis = {0, 0, 1}});
        }
        world.watch_contact_problems([this](const StepProblem& step) {
            problems.push_back(step);
            worst = std::max(worst, problem_error(step.problem, step.impulse).relative);
        });
    }
    static Settings settings() {
        Settings settings = Stack::exact();
        settings.tolerance = 1e-13;
        settings.step_size = 5e-3;
        return settings;
    }
};

}  // namespace

TEST_CASE("the impulses of a step at large strain solve its problem, with and without equations", "[unit][problem]") {
    const bool is_welded = GENERATE(false, true);
    const auto modulus = GENERATE(2e4, 1e6);  // [Pa]; large strain with the first
    Padded padded(modulus, 0.5, is_welded);
    const StepReport report = padded.world.advance(0.1);
    REQUIRE(report.ok());
    REQUIRE(report.unconverged == 0);
    CHECK(padded.problems.size() > 15);
    CHECK(padded.worst < 1e-10);
}

TEST_CASE("a problem with eliminated equations gives the velocities of other impulses", "[unit][problem]") {
    const auto modulus = GENERATE(2e4, 1e6);  // [Pa]
    // In the first step the worlds differ only in friction. So the impulses of one are other impulses for the other.
    Padded rough(modulus, 0.5), smooth(modulus, 0.2);
    REQUIRE(rough.world.advance(5e-3).unconverged == 0);
    REQUIRE(smooth.world.advance(5e-3).unconverged == 0);
    REQUIRE(rough.problems.size() == 1);
    const StepProblem &of_rough = rough.problems[0], &of_smooth = smooth.problems[0];
    const std::vector<Vec3> u = velocities(of_smooth.problem, of_smooth.impulse);
    CHECK(distance(of_smooth.impulse, of_rough.impulse) > 0.1 * largest(of_rough.impulse));
    CHECK(distance(velocities(of_rough.problem, of_rough.impulse), u) > 0.01 * largest(u));
    CHECK(distance(velocities(of_rough.problem, of_smooth.impulse), u) < 1e-10 * largest(of_rough.problem.q));
}

TEST_CASE("contacts whose normals a joint holds are left out of problems", "[unit][problem]") {
    Settings settings;
    settings.step_size = 5e-3;
    World world(settings);
    const auto rubber = world.add_material({.density = 500, .friction = 0.5});
    const Mesh box = mesh::box({0.5, 0.5, 0.5}, {1, 1, 1});
    const BodyHandle block = world.add_body(box, {.material = rubber, .dynamics = BodyDynamics::rigid});
    world.add_body(box, {.material = rubber, .position = {2, 0, -1}, .dynamics = BodyDynamics::rigid});
    world.add_collider(Plane{.normal = {1, 0, 0}, .point = {-0.2501, 0, 0}}, {.friction = 0});
    world.add_collider(Plane{.point = {0, 0, -1.2501}});
    Joints(world).add({.kind = JointKind::slider, .first = block, .axis = {0, 0, 1}});
    int steps = 0;
    world.watch_contact_problems([&](const StepProblem& step) {
        ++steps;
        CHECK(step.contact.size() == 4);
        CHECK(problem_error(step.problem, step.impulse).relative < 1e-3);
        const ProblemSolution again = solve_problem(step.problem, {.tolerance = 1e-9});
        CHECK(again.converged);
        CHECK(largest(again.reaction) <= 2 * largest(step.impulse));
        CHECK(step.problem.description.find("along their normals: 4") != std::string::npos);
    });
    REQUIRE(world.advance(0.01).ok());
    CHECK(steps == 2);
}

TEST_CASE("redundant hinges leave a gate its rotation in exported problems", "[unit][problem]") {
    struct Case {
        int hinges;
        Real tilt, gap;  // [rad], [m]
    };
    const auto [hinges, tilt, gap] = GENERATE(Case{1, 0, 0.05}, Case{2, 0, 0.05}, Case{3, 0, 0.05}, Case{2, 1e-6, 0.05},
                                              Case{2, 1e-5, 0.05}, Case{1, 0, 5e-4}, Case{3, 0, 5e-4});
    const bool is_close = gap < 0.01;  // the wall also touches the gate at its hinges
    INFO(hinges << " hinges, tilt " << tilt << ", gap " << gap);
    Settings settings;
    settings.step_size = 5e-3;
    settings.gravity = {0, 5, -9.81};
    World world(settings);
    const auto wood = world.add_material({.density = 1000, .friction = 0.5});
    const BodyHandle gate = world.add_body(mesh::box({1, 0.1, 2}, {1, 1, 1}), {.material = wood,
                                                                               .position = {0.5, 0, 1},
                                                                               .velocity = {0, 1, 0},
                                                                               .angular_velocity = {0, 0, 2},
                                                                               .dynamics = BodyDynamics::rigid});
    world.add_collider(Plane{.normal = {0, -1, 0}, .point = {0, gap + 0.05, 0}});
    Joints joints(world);
    for (int k = 0; k < hinges; ++k)
        joints.add({.kind = JointKind::hinge,
                    .first = gate,
                    .point = {0, 0, 1.5 - 0.4 * k},
                    .axis = {k == 1 ? tilt : 0, 0, 1}});
    const Real mass = 200, inertia = mass * (1.01 / 12 + 0.25);  // [kg], [kg m^2] about the hinges
    std::size_t contacts = 0, left_out = 0;
    world.watch_contact_problems([&](const StepProblem& step) {
        contacts += step.contact.size();
        left_out += world.contacts().size() - step.contact.size();
        CHECK(problem_error(step.problem, step.impulse).relative < 1e-3);
        const ProblemSolution again = solve_problem(step.problem, {.tolerance = 1e-9});
        CHECK(again.converged);
        // Contacts above each other share their force in any way, but the moment about the hinges is unique.
        Real moment = 0, moment_again = 0;
        for (std::size_t i = 0; i < step.contact.size(); ++i) {
            const Real arm = world.contacts()[step.contact[i]].point.x();
            for (Index k = step.problem.row_offset[i]; k < step.problem.row_offset[i + 1]; ++k) {
                if (step.problem.column[k] != static_cast<Index>(i)) continue;
                CHECK(step.problem.block[k](0, 0) == Approx(arm * arm / inertia).epsilon(1e-2));
                const Vec3 lever = step.problem.block[k].row(0).transpose() * (inertia / arm);
                moment += lever.dot(step.impulse[i]);
                moment_again += lever.dot(again.reaction[i]);
            }
        }
        CHECK(moment_again == Approx(moment).epsilon(1e-2));
    });
    REQUIRE(world.advance(is_close ? 0.015 : 0.1).ok());
    CHECK(contacts >= (is_close ? 6 : 20));
    CHECK(left_out == (is_close ? 6 : 0));
}

}  // namespace skerry::test::problem_export_test
