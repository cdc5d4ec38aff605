// The live view without its server: the stream to browsers that are slow or hang, and refused browsers.
#include <catch2/catch.hpp>

#include <list>
#include <map>

#include "engine/live/server/admission.h"
#include "tests/unit/engine/live_browser.h"
#include "tests/unit/engine/output_sample.h"
#include "tests/unit/engine/page_stream_reader.h"

namespace skerry::test::live_test {

using Catch::Matchers::Contains;

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
    for (std::uint64_t step = 0; step < 80; ++step) {
        REQUIRE(world.advance(0.005).ok());
        positions[world.time()].assign(world.positions(cube).begin(), world.positions(cube).end());
        const std::size_t frames = visit.browser.rows().size();
        const bool ready = hub.requested_frame().frame;
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
        taker.take(world, FrameContent::motion, *snapshot);
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
    CHECK_THAT(visit.browser.wait_for_text("problem")["text"], Contains("found 1000 waiting commands"));
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

}  // namespace skerry::test::live_test
