// The live view without its server: encoder, browsers that are slow or hang, commands, and the pace of the simulation.
#include <catch2/catch.hpp>

#include <chrono>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "engine/live/live_run.h"
#include "engine/live/server/admission.h"
#include "tests/support/message_of.h"
#include "tests/unit/engine/output_sample.h"
#include "tests/unit/engine/page_stream_reader.h"

namespace skerry::test::live_test {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using Json = nlohmann::json;

namespace {

constexpr std::chrono::seconds patience(20);  // far longer than any wait of a test that passes

/// A browser that stores all messages.
class Browser final : public LiveLink {
public:
    bool send_text(std::string_view text) override {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !hangs_; });
        texts_.emplace_back(text);
        changed_.notify_all();
        return true;
    }
    bool send_bytes(std::string_view bytes) override {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !hangs_; });
        bytes_ += bytes;
        ++frames_;
        changed_.notify_all();
        return true;
    }
    void close() override {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        changed_.notify_all();
    }

    /// While it hangs, each message to it waits.
    void hang(bool on) {
        const std::lock_guard lock(mutex_);
        hangs_ = on;
        changed_.notify_all();
    }
    /// Waits until it has got `count` frames.
    void wait_for_frames(std::size_t count) {
        std::unique_lock lock(mutex_);
        REQUIRE(changed_.wait_for(lock, patience, [&] { return frames_ >= count; }));
    }
    /// Waits for a message that contains `part`, and returns it.
    Json wait_for_text(const std::string& part) {
        std::unique_lock lock(mutex_);
        std::string found;
        REQUIRE(changed_.wait_for(lock, patience, [&] {
            for (const std::string& text : texts_)
                if (text.find(part) != std::string::npos) found = text;
            return !found.empty();
        }));
        return Json::parse(found);
    }
    void wait_for_texts(const std::string& begin, std::ptrdiff_t count) {
        std::unique_lock lock(mutex_);
        REQUIRE(changed_.wait_for(lock, patience, [&] { return count_begins(begin) >= count; }));
    }
    /// Number of messages with this beginning.
    std::ptrdiff_t count_texts(const std::string& begin) {
        const std::lock_guard lock(mutex_);
        return count_begins(begin);
    }
    void wait_for_end() {
        std::unique_lock lock(mutex_);
        REQUIRE(changed_.wait_for(lock, patience, [&] { return closed_; }));
    }
    std::string bytes() {
        const std::lock_guard lock(mutex_);
        return bytes_;
    }
    std::vector<Json> rows() {
        const std::lock_guard lock(mutex_);
        std::vector<Json> rows;
        for (const std::string& text : texts_)
            if (text.starts_with(R"({"type":"row")")) rows.push_back(Json::parse(text));
        return rows;
    }

private:
    std::ptrdiff_t count_begins(const std::string& begin) const {
        return std::ranges::count_if(texts_, [&](const std::string& text) { return text.starts_with(begin); });
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> texts_;
    std::string bytes_;
    std::size_t frames_ = 0;
    bool hangs_ = false, closed_ = false;
};

/// A browser that is connected during the lifetime of this object.
struct Visit {
    explicit Visit(LiveHub& hub_) : hub(hub_), number(hub.join(browser)) {}
    ~Visit() {
        browser.hang(false);
        hub.leave(number);
    }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

    void send(const Json& command) { hub.receive(number, command.dump()); }
    void acknowledge(std::uint64_t frame) { send({{"do", "seen"}, {"number", frame}}); }

    Browser browser;
    LiveHub& hub;
    std::uint64_t number;
};

/// A soft cube that falls to a floor.
World falling_cube(int threads = 1) {
    World world(Settings{.threads = threads});
    world.add_collider(Plane{}, {.name = "floor"});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
                   {.material = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 5}),
                    .position = {0, 0, 0.06},
                    .name = "cube"});
    return world;
}

void take_and_publish(LiveHub& hub, SnapshotTaker& taker, const World& world, bool stresses = false) {
    hub.mark_changed();
    const std::shared_ptr<Snapshot> snapshot = hub.free_snapshot();
    taker.take(world, stresses, *snapshot);
    hub.publish(snapshot);
}

/// Wall time that a call takes [s].
Real seconds_of(auto&& call) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
}

/// Longer than the time between two snapshots.
void wait_for_next_frame() {
    std::this_thread::sleep_for(std::chrono::milliseconds(35));
}

/// Shows the world to the browser until it has got a row for which `is_wanted` is true. Returns this row.
Json row_with(Visit& visit, LiveRun& run, World& world, auto&& is_wanted) {
    for (int i = 0; i < 100; ++i) {
        visit.acknowledge(visit.browser.rows().size());
        run.sync(world);
        if (const std::vector<Json> rows = visit.browser.rows(); !rows.empty() && is_wanted(rows.back()))
            return rows.back();
        wait_for_next_frame();
    }
    FAIL("the browser has not got the row");
    return {};
}

}  // namespace

TEST_CASE("a browser gets the bytes of the frames of a recorded page", "[unit][live]") {
    OutputSample sample(3, 2, 30);
    PageData recorded;
    LiveEncoder encoder;
    std::string bytes;
    Json bodies = Json::array(), colliders = Json::array(), lines = Json::array();
    for (int i = 0; i < sample.frame_count(); ++i) {
        Snapshot snapshot;
        snapshot.frame = sample.frame(i);
        recorded.add(snapshot.frame);
        const LiveEncoder::Messages messages = encoder.pack(snapshot, static_cast<std::uint64_t>(i) + 1, 1);
        bytes += messages.changes;
        const Json row = Json::parse(messages.row);
        CHECK(row["number"] == i + 1);
        CHECK(row["contacts"] == snapshot.frame.contacts.size());
        CHECK(row["pull"].is_null());
        if (messages.added.empty()) continue;
        const Json added = Json::parse(messages.added);
        for (const auto& name : added["bodies"]) bodies.push_back(name);
        for (const auto& collider : added["colliders"]) colliders.push_back(collider);
        for (const auto& line : added["lines"]) lines.push_back(line);
    }
    CHECK(bytes == inflate_all(recorded.packed_frames()));
    const Json page = Json::parse(text_of(json_of_objects(recorded.stream(), {})));
    CHECK(bodies == page["bodies"]);
    CHECK(colliders == page["colliders"]);
    CHECK(lines == page["lines"]);
}

TEST_CASE("a browser that misses frames decodes those that it gets", "[unit][live]") {
    World world = falling_cube();
    const BodyHandle cube = world.bodies().front();
    LiveHub hub;
    hub.begin_run({}, {});
    SnapshotTaker taker;
    Visit visit(hub);
    visit.browser.wait_for_text("begin");
    std::map<Real, std::vector<Vec3>> positions;  // by time
    for (std::uint64_t step = 0; step < 40; ++step) {
        REQUIRE(world.advance(0.005).ok());
        positions[world.time()].assign(world.positions(cube).begin(), world.positions(cube).end());
        const std::size_t frames = visit.browser.rows().size();
        const bool ready = hub.wish().frame;
        take_and_publish(hub, taker, world);
        if (ready) visit.browser.wait_for_frames(frames + 1);
        if (step % 5 == 4) visit.acknowledge(visit.browser.rows().size());  // meanwhile others were dropped
    }
    hub.leave(visit.number);  // no frame is on its way any more
    const ReadRun run = read_frames(visit.browser.bytes());
    const std::vector<Json> rows = visit.browser.rows();
    REQUIRE(run.frames.size() == rows.size());
    CHECK(rows.size() >= 10);
    CHECK(hub.frames_dropped() >= 10);
    const ReadShape& shape = run.shapes.front();
    for (std::size_t f = 0; f < rows.size(); ++f) {
        const std::vector<Vec3>& expected = positions.at(rows[f]["time"].get<Real>());
        Real largest = 0;
        for (std::size_t v = 0; v < shape.node.size(); ++v)
            largest = std::max(
                largest, (run.frames[f].bodies.front().position[v] - expected[static_cast<std::size_t>(shape.node[v])])
                             .cwiseAbs()
                             .maxCoeff());
        CHECK(largest <= 0.5001 * shape.step);  // rounding to the lattice
    }
}

TEST_CASE("a browser that hangs delays neither the simulation nor other browsers", "[unit][live]") {
    World world = falling_cube();
    LiveHub hub;
    hub.begin_run({}, {});
    SnapshotTaker taker;
    Visit slow(hub), fast(hub);
    slow.browser.wait_for_text("begin");
    slow.browser.hang(true);
    for (std::uint64_t frame = 1; frame <= 20; ++frame) {
        REQUIRE(world.advance(0.001).ok());
        take_and_publish(hub, taker, world);
        fast.browser.wait_for_frames(frame);
        fast.acknowledge(frame);
    }
    slow.browser.hang(false);
    slow.browser.wait_for_frames(1);
    CHECK(slow.browser.rows().size() <= 2);  // it has not acknowledged any frame

    SECTION("and is dropped when too many messages wait for it") {
        slow.browser.hang(true);
        for (std::size_t i = 0; i < LiveHub::most_waiting + 2; ++i) hub.receive(slow.number, "{}");
        slow.browser.hang(false);
        slow.browser.wait_for_end();
    }
}

TEST_CASE("the memory of a live stream does not grow with its length", "[unit][live]") {
    World world = falling_cube();
    LiveHub hub;
    hub.begin_run({}, {});
    SnapshotTaker taker;
    Visit visit(hub);
    std::map<const Snapshot*, int> used;
    for (std::uint64_t frame = 1; frame <= 50; ++frame) {
        REQUIRE(world.advance(0.001).ok());
        hub.mark_changed();
        const std::shared_ptr<Snapshot> snapshot = hub.free_snapshot();
        ++used[snapshot.get()];
        taker.take(world, false, *snapshot);
        hub.publish(snapshot);
        visit.browser.wait_for_frames(frame);
        visit.acknowledge(frame);
    }
    // One snapshot is filled, one is the latest, and one may be in use for the browser.
    CHECK(used.size() <= 3);
}

TEST_CASE("a live stream starts anew when most of its objects are gone", "[unit][live]") {
    LiveHub hub;
    hub.begin_run({}, {});
    Visit visit(hub);
    const auto streams = [&] { return visit.browser.count_texts(R"({"type":"begin")"); };
    const auto show = [&](std::uint32_t generation) {
        hub.mark_changed();
        const std::shared_ptr<Snapshot> snapshot = hub.free_snapshot();
        snapshot->frame = {};
        for (std::uint32_t slot = 0; slot < 300; ++slot)
            snapshot->frame.lines.push_back({.kind = LineKind::spring,
                                             .slot = slot,
                                             .generation = generation,
                                             .name = {},
                                             .points = {Vec3::Zero()},
                                             .force = {0}});
        hub.publish(snapshot);
    };
    // The fifth frame brings the stream to 1500 lines, of which 1200 are gone.
    for (std::uint32_t frame = 1; frame < 10; ++frame) {
        show(frame);
        visit.browser.wait_for_frames(frame);
        visit.acknowledge(frame);
        if (frame == 5)
            visit.browser.wait_for_texts(R"({"type":"begin")", 2);
        else
            CHECK(streams() == (frame < 5 ? 1 : 2));
    }
}

TEST_CASE("a browser that looks changes no bit of the run", "[unit][live]") {
    const auto hash_of_run = [](bool seen) {
        World world = falling_cube(2);
        const BodyHandle cube = world.bodies().front();
        LiveRun run(world, {.probes = {{.name = "force", .what = BodyForceProbe{.body = cube}}}});
        std::optional<Visit> visit;
        if (seen) {
            visit.emplace(run.hub());
            visit->send({{"do", "fields"}, {"names", {"stress"}}});
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
            // A second row of the same time has no mean force.
            CHECK(std::ranges::any_of(rows, [](const Json& row) { return !row["probes"][0][0].is_null(); }));
        }
        return world.state_hash();
    };
    CHECK(hash_of_run(true) == hash_of_run(false));
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
          "command: names: found [\"heat\"], expected a list of speed, stress and strain");
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
        visit.send({{"do", "reset"}});
        CHECK(run.due(world) > 0);
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

TEST_CASE("more browsers and more commands than the limits are refused", "[unit][live]") {
    LiveHub hub;
    hub.begin_run({}, {});
    std::list<Visit> visits;
    for (std::size_t i = 0; i < LiveHub::most_clients; ++i) CHECK(visits.emplace_back(hub).number != 0);
    Browser late;
    CHECK(hub.join(late) == 0);
    CHECK_THAT(late.wait_for_text("problem")["text"], Contains("found 4 browsers"));
    visits.pop_back();
    CHECK(hub.clients() == 3);

    Visit& visit = visits.front();
    hub.take_commands();
    for (std::size_t i = 0; i < LiveHub::most_waiting + 1; ++i) visit.send({{"do", "play"}});
    CHECK_THAT(visit.browser.wait_for_text("problem")["text"], Contains("found 1000 commands that wait"));
    CHECK(hub.take_commands().size() == LiveHub::most_waiting);
    // Only the last place of the mouse and the last value of a slider count.
    for (int i = 0; i < 5000; ++i) visit.send({{"do", "move"}, {"to", {i, 0, 0}}});
    CHECK(hub.take_commands().size() == 1);
}

TEST_CASE("a request from elsewhere is refused", "[unit][live]") {
    const std::string token = random_token();
    CHECK(token.size() == 32);
    CHECK(token != random_token());
    const std::string right = "token=" + token, wrong = "token=" + std::string(32, '0');
    const std::string_view own = "127.0.0.1:8080", same = "http://127.0.0.1:8080";
    const auto verdict = [&](LiveRequest request) { return admission(request, 8080, token); };
    const LiveRequest page{.method = "GET", .path = "/", .query = "", .hosts = {own}, .origins = {}};
    const LiveRequest stream{
        .method = "GET", .path = "/live", .query = right, .hosts = {own}, .origins = {same}, .upgrade = true};
    CHECK(verdict(page) == Admission::page);
    CHECK(verdict(stream) == Admission::stream);
    const auto refuses = [&](LiveRequest request, auto&& change) {
        change(request);
        return verdict(request) == Admission::refused;
    };
    for (const LiveRequest& request : {page, stream}) {
        CHECK(refuses(request, [](LiveRequest& r) { r.hosts = {"skerry.example:8080"}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.hosts = {"127.0.0.1:80"}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.hosts = {}; }));
        CHECK(refuses(request, [&](LiveRequest& r) { r.hosts = {own, own}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.origins = {"http://skerry.example"}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.origins = {"null"}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.origins = {"http://localhost:8080"}; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.path = "/etc/passwd"; }));
        CHECK(refuses(request, [](LiveRequest& r) { r.method = "POST"; }));
    }
    CHECK(refuses(stream, [&](LiveRequest& r) { r.query = wrong; }));
    CHECK(refuses(stream, [](LiveRequest& r) { r.query = ""; }));
    CHECK(refuses(stream, [](LiveRequest& r) { r.origins = {}; }));
    CHECK(refuses(stream, [](LiveRequest& r) { r.upgrade = false; }));
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
