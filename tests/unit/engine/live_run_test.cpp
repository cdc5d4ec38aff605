// The live view without its server: commands, pulls and the pace of the simulation.
#include <catch2/catch.hpp>

#include <optional>
#include <string>

#include "tests/support/message_of.h"
#include "tests/unit/engine/live_browser.h"

namespace skerry::test::live_test {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("a browser that looks changes no bit of the run", "[unit][live]") {
    const auto hash_of_run = [](const std::string& field) {
        const bool seen = !field.empty();
        World world = falling_cube(2);
        const BodyHandle cube = world.bodies().front();
        LiveRun run(world, {.probes = {{.name = "force", .what = BodyForceProbe{.body = cube}}}});
        std::optional<Visit> visit;
        if (seen) {
            visit.emplace(run.hub());
            visit->send({{"do", "fields"}, {"names", {field}}});
        }
        for (int call = 0; call < 40; ++call) {
            REQUIRE(world.advance(0.005, [&](const StepReport&) { return run.between_steps(world); }).ok());
            run.sync(world);
            if (!seen || call % 8 != 7) continue;
            row_with(*visit, run, world, [&](const Json& row) { return row["time"] == world.time(); });
            wait_for_next_frame();
        }
        if (seen) {
            const std::vector<Json> rows = visit->browser.rows();
            REQUIRE(rows.size() >= 4);
            CHECK(rows.back()["top"]["stress"] > 0);
            CHECK((rows.back()["top"]["error"] > 0) == (field == "error"));  // computed only where it is shown
            // A second row of the same time has no mean force.
            CHECK(std::ranges::any_of(rows, [](const Json& row) { return !row["probes"][0][0].is_null(); }));
        }
        return world.state_hash();
    };
    CHECK(hash_of_run("stress") == hash_of_run(""));
    CHECK(hash_of_run("error") == hash_of_run(""));
}

TEST_CASE("a browser that leaves ends a call of advance only if it pulls a body", "[unit][live]") {
    World world = falling_cube();
    LiveRun run(world, {});
    std::optional<Visit> visit;
    visit.emplace(run.hub());
    const bool pulls = GENERATE(false, true);
    if (pulls) {
        row_with(*visit, run, world, [](const Json&) { return true; });
        visit->send({{"do", "pull"}, {"body", 0}, {"point", {0, 0, 0.1}}, {"to", {0, 0, 0.3}}});
        run.sync(world);
        CHECK_FALSE(Springs(world).all().empty());
    }
    const auto go_on = [&](const StepReport&) {
        visit.reset();
        return run.between_steps(world);
    };
    CHECK(world.advance(0.02, go_on).status == (pulls ? StepStatus::stopped : StepStatus::ok));
    run.sync(world);
    CHECK(Springs(world).all().empty());
}

TEST_CASE("the pulls of a view that is closed end", "[unit][live]") {
    World world = falling_cube();
    const std::uint64_t start = world.state_hash();
    LiveRun run(world, {});
    Visit visit(run.hub());
    row_with(visit, run, world, [](const Json&) { return true; });
    visit.send({{"do", "pull"}, {"body", 0}, {"point", {0, 0, 0.1}}, {"to", {0, 0, 0.3}}});
    run.sync(world);
    CHECK(world.state_hash() != start);
    run.end_pulls(world);
    CHECK(world.state_hash() == start);
}

TEST_CASE("the switch of gravity follows the owner of the world and other views", "[unit][live]") {
    World world = falling_cube();
    const World start = world.clone();
    const Vec3 gravity = world.settings().gravity;
    LiveRun run(world, {}), other(world, {});
    Visit visit(run.hub()), other_visit(other.hub());
    for (const auto& [hub, guest] : {std::pair(&run, &visit), std::pair(&other, &other_visit)}) {
        guest->send({{"do", "gravity"}, {"on", false}});
        hub->sync(world);
    }
    other_visit.send({{"do", "gravity"}, {"on", true}});
    other.sync(world);
    CHECK(world.settings().gravity == gravity);
    visit.send({{"do", "gravity"}, {"on", false}});
    run.sync(world);
    CHECK(world.settings().gravity == Vec3::Zero());
    CHECK_FALSE(run.hub().state().gravity);
    world.reset(start);
    run.sync(world);
    CHECK(run.hub().state().gravity);
    world.set_gravity(Vec3::Zero());
    run.sync(world);
    CHECK_FALSE(run.hub().state().gravity);
}

TEST_CASE("a command is refused with the member at fault", "[unit][live]") {
    const auto refusal = [](const std::string& text) { return message_of([&] { read_command(text); }); };
    CHECK(refusal("") == "command: found nothing, expected a JSON object such as {\"do\":\"play\"}");
    CHECK_THAT(refusal(std::string(5000, '[')), StartsWith("command: found [[[["));
    CHECK_THAT(refusal(R"({"do":"plya"})"),
               Contains("do: found \"plya\", expected one of seen, fields, play, pause") && Contains("play\""));
    CHECK(refusal(R"({"do":"rate"})") == "command: value: found nothing, expected a value");
    CHECK(refusal(R"({"do":"rate","value":"1"})") == "command: value: found \"1\", expected a number");
    CHECK(refusal(R"({"do":"rate","value":1,"on":true})") ==
          "command: on: found an unknown member, expected only the members of \"rate\"");
    CHECK(refusal(R"({"do":"gravity","on":1})") == "command: on: found 1, expected true or false");
    CHECK(refusal(R"({"do":"slider","number":-1,"value":0})") ==
          "command: number: found -1, expected a whole number of at least 0");
    CHECK(refusal(R"({"do":"move","to":[0,1]})") == "command: to: found [0,1], expected three coordinates [m]");
    CHECK(refusal(R"({"do":"fields","names":["heat"]})") ==
          "command: names: found [\"heat\"], expected a list of speed, stress, strain and error");
    const LiveCommand pull = read_command(R"({"do":"pull","body":3,"point":[1,2,3],"to":[4,5,6]})");
    CHECK(pull.action == LiveAction::pull);
    CHECK(pull.body_number == 3);
    CHECK(pull.point == Vec3(1, 2, 3));
    CHECK(pull.to == Vec3(4, 5, 6));
}

TEST_CASE("commands control the run, and a reset brings the start back", "[unit][live]") {
    World world = falling_cube();
    const std::uint64_t start = world.state_hash();
    LiveRun run(world, {.paused = true});
    Visit visit(run.hub());
    CHECK(run.due(world) == 0);

    visit.send({{"do", "step"}});
    const Real step = run.due(world);
    const StepReport report = world.advance(step);
    CHECK(report.steps == 1);
    CHECK(report.step_size == Approx(1.0 / 60 / std::ceil(1.0 / 60 / world.stable_step())));
    CHECK(run.due(world) == 0);

    visit.send({{"do", "rate"}, {"value", 0}});
    visit.send({{"do", "gravity"}, {"on", false}});
    visit.send({{"do", "play"}});
    CHECK(run.due(world) > 0);
    CHECK(world.settings().gravity == Vec3::Zero());
    CHECK(visit.browser.wait_for_text(R"("type":"state")")["gravity"] == false);
    row_with(visit, run, world, [](const Json&) { return true; });
    visit.send({{"do", "pull"}, {"body", 0}, {"point", {0, 0, 0.1}}, {"to", {0, 0, 0.3}}});
    CHECK(run.due(world) > 0);
    REQUIRE(world.advance(0.01).ok());
    CHECK(row_with(visit, run, world, [](const Json& row) { return !row["pull"].is_null(); })["pull"]["force"] > 0);
    CHECK(visit.browser.wait_for_text(R"("type":"add")")["lines"].empty());

    visit.send({{"do", "reset"}});
    CHECK(run.due(world) > 0);
    CHECK(world.state_hash() == start);
    CHECK(run.resets() == 1);
    CHECK(row_with(visit, run, world, [](const Json& row) { return row["time"] == 0; })["pull"].is_null());

    SECTION("a command that fails is reported, and changes nothing") {
        visit.send({{"do", "slider"}, {"number", 2}, {"value", 0}});
        visit.send({{"do", "pull"}, {"body", 1}, {"point", {0, 0, 0}}, {"to", {0, 0, 0}}});
        visit.send({{"do", "rate"}, {"value", -1}});
        run.sync(world);
        CHECK_THAT(visit.browser.wait_for_text("number: found 2")["text"], Contains("0 sliders"));
        visit.browser.wait_for_text("body: found 1, expected one of the 1 bodies");
        visit.browser.wait_for_text("rate: found -1");
        CHECK(world.state_hash() == start);
    }
    SECTION("a step that failed pauses the run until it is reset") {
        run.fail("body 'cube' is too fast");
        CHECK(run.due(world) == 0);
        visit.browser.wait_for_text("too fast");
        {
            Visit later(run.hub());
            later.browser.wait_for_text("too fast");
        }
        visit.send({{"do", "reset"}});
        CHECK(run.due(world) > 0);
        Visit last(run.hub());
        last.browser.wait_for_texts(R"({"type":"begin")", 1);
        CHECK(last.browser.count_texts(R"({"type":"problem")") == 0);
    }
    SECTION("a long call of advance ends when a command arrives") {
        visit.send({{"do", "pause"}});
        CHECK(world.advance(1, [&](const StepReport&) { return run.between_steps(world); }).status ==
              StepStatus::stopped);
    }
}

TEST_CASE("simulated time follows the wall clock at the rate", "[unit][live]") {
    // The simulation is at most one call of advance ahead. Only on a busy machine it may be late: the quickest run
    // counts.
    constexpr Real expected = 0.1 / 0.5, call = 1.0 / 60 / 0.5, tolerance = 0.05;
    Real quickest = 2 * expected;
    for (int attempt = 0; attempt < 10 && quickest > expected + tolerance; ++attempt) {
        World world = falling_cube();
        LiveRun run(world, {.rate = 0.5});
        const Real wall = seconds_of([&] {
            while (world.time() < 0.1)
                if (const Real length = run.due(world); length > 0) REQUIRE(world.advance(length).ok());
        });
        CHECK(wall >= expected - call);
        quickest = std::min(quickest, wall);
    }
    CHECK(quickest <= expected + tolerance);
}

TEST_CASE("sync waits for a command while the view is paused, and never while it plays", "[unit][live]") {
    World world = falling_cube();
    LiveRun run(world, {.paused = true});
    const auto seconds_of_sync = [&] { return seconds_of([&] { run.sync(world); }); };
    CHECK(seconds_of_sync() >= 0.015);  // without a browser
    Visit visit(run.hub());
    CHECK(seconds_of_sync() >= 0.015);
    for (const char* command : {"step", "play"}) {
        visit.send({{"do", command}});
        run.sync(world);
        CHECK(run.playing());
    }
    Real quickest = 1;
    for (int call = 0; call < 20; ++call) quickest = std::min(quickest, seconds_of_sync());
    CHECK(quickest < 0.015);
}

TEST_CASE("settings of a live view are checked", "[unit][live]") {
    World world = falling_cube();
    CHECK(message_of([&] { LiveView(world, {.port = 70000}); }) ==
          "live view: port: found 70000, expected a port from 0 to 65535 (0: a free port)");
    CHECK_THAT(message_of([&] { LiveView(world, {.rate = -1}); }), Contains("rate: found -1"));
    LiveView view(world, {});
    const std::string port = view.address().substr(17, view.address().find("/#") - 17);
    CHECK_THAT(message_of([&] { LiveView(world, {.port = std::stoi(port)}); }),
               StartsWith("live view: port: found " + port + ", which cannot be opened"));
    view.close();
    CHECK_FALSE(view.is_open());
    CHECK(view.due(world) == 0);
}

}  // namespace skerry::test::live_test
