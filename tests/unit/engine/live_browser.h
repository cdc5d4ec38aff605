// Browsers without a network for tests of the live view, and a world that they show.
#pragma once

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "engine/live/live_run.h"

namespace skerry::test::live_test {

using Json = nlohmann::json;

inline constexpr std::chrono::seconds patience(20);  // far longer than any wait of a test that passes

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
inline World falling_cube(int threads = 1) {
    World world(Settings{.threads = threads});
    world.add_collider(Plane{}, {.name = "floor"});
    world.add_body(mesh::box({0.1, 0.1, 0.1}, {3, 3, 3}),
                   {.material = world.add_material({.young_modulus = 1e5, .density = 1000, .damping = 5}),
                    .position = {0, 0, 0.06},
                    .name = "cube"});
    return world;
}

inline void take_and_publish(LiveHub& hub, SnapshotTaker& taker, const World& world) {
    hub.mark_changed();
    const std::shared_ptr<Snapshot> snapshot = hub.free_snapshot();
    taker.take(world, FrameContent::motion, *snapshot);
    hub.publish(snapshot);
}

/// Wall time that a call takes [s].
inline Real seconds_of(auto&& call) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
}

/// Longer than the time between two snapshots.
inline void wait_for_next_frame() {
    std::this_thread::sleep_for(std::chrono::milliseconds(35));
}

/// Shows the world to the browser until it has got a row for which `is_wanted` is true. Returns this row.
inline Json row_with(Visit& visit, LiveRun& run, World& world, auto&& is_wanted) {
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

}  // namespace skerry::test::live_test
