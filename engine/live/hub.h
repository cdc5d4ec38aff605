// The browsers that are connected to a live view. They pass commands to the simulation and get its snapshots.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "engine/live/command.h"
#include "engine/live/messages.h"
#include "engine/live/snapshot.h"

namespace skerry {

/// Connection to one browser. The functions return false if the connection is broken.
class LiveLink {
public:
    virtual ~LiveLink() = default;
    virtual bool send_text(std::string_view text) = 0;
    virtual bool send_bytes(std::string_view bytes) = 0;
    /// Starts to close the connection. When it has ended, the owner of the link calls LiveHub::leave.
    virtual void close() = 0;
};

/// Passes commands from the browsers to the simulation, and snapshots from the simulation to the browsers.
///
/// - Threads: each browser has its own thread, which encodes and sends frames. So a browser that hangs does not delay
///   the others.
/// - Streams: a stream is a sequence of frames for one browser. Its first frame is complete; each later one contains
///   the differences from the frame sent before it.
/// - Slow browsers: a browser gets a new frame while at most one earlier frame is unacknowledged. Frames that it misses
///   are not encoded.
class LiveHub {
public:
    static constexpr std::size_t most_clients = 4;
    // Largest number of waiting commands of all browsers together. Also the largest number of messages that wait for
    // one browser.
    static constexpr std::size_t most_waiting = 1000;

    LiveHub() = default;
    ~LiveHub();
    LiveHub(const LiveHub&) = delete;
    LiveHub& operator=(const LiveHub&) = delete;

    // The next functions are for the threads of the connections.

    /// Adds a browser and returns its number. After close() returns 0. If most_clients browsers are connected, sends
    /// the new one an error message and returns 0. `link` must live until leave().
    std::uint64_t join(LiveLink& link);
    /// Removes a browser after waiting for its thread. If the browser pulls a body, adds a command that ends the pull.
    /// Otherwise adds no command, because a command ends a call of advance and so changes the length of the steps.
    void leave(std::uint64_t client);
    /// Takes a message of a browser. A message that is no command is answered with an error message.
    void receive(std::uint64_t client, std::string_view text);

    // The next functions are for the thread of the simulation.

    /// True if commands wait, or browsers are connected. Reads an atomic variable and takes no lock.
    bool is_busy() const { return busy_.load(std::memory_order_relaxed); }
    bool has_commands() const { return commands_waiting_.load(std::memory_order_relaxed); }
    std::vector<LiveCommand> take_commands();
    /// Starts a new run. All browsers start new streams.
    void begin_run(const LiveRunInfo& info, const LiveState& state);
    /// Sends the state to all browsers if it has changed.
    void set_state(const LiveState& state);
    /// Sends the text of a problem to a browser.
    void report(std::uint64_t client, const std::string& problem);
    /// Sends all browsers the reason why the run has failed. Browsers that join before the run continues get it too.
    void report_failure(const std::string& reason);
    /// Notes that the world may differ from the last snapshot, so that browsers get a new frame.
    void mark_changed();

    struct FrameRequest {
        bool frame = false;                           // at least one browser waits for a frame
        FrameContent content = FrameContent::motion;  // least content with the fields that these browsers show
    };
    /// Finds out whether browsers wait for a frame, and the fields that they show. A browser that has not acknowledged
    /// earlier frames does not wait; one dropped frame is counted for it if the world has changed since its last frame.
    FrameRequest requested_frame();
    /// Returns a snapshot to be overwritten: one that no browser reads any more, or a new one.
    std::shared_ptr<Snapshot> free_snapshot();
    void publish(std::shared_ptr<Snapshot> snapshot);
    /// Waits until a command arrives, or until `end`.
    void wait_for_commands(std::chrono::steady_clock::time_point end);
    /// Ends all connections. join() refuses later ones.
    void close();

    // For any thread.

    LiveState state() const;
    int clients() const;
    std::uint64_t frames_sent() const { return sent_.load(std::memory_order_relaxed); }
    std::uint64_t frames_dropped() const { return dropped_.load(std::memory_order_relaxed); }

private:
    struct Client {
        std::uint64_t number = 0;
        LiveLink* link = nullptr;
        bool closed = false;  // true: its thread ends the connection
        FrameContent requested_content =
            FrameContent::motion;       // smallest content that has all fields that the browser shows
        bool pulls = false;             // true: the browser pulls a body
        std::deque<std::string> texts;  // messages that wait for its thread
        // number of the run that its stream shows; 0: it needs a new stream
        std::uint64_t run = 0;
        std::uint64_t snapshot = 0;        // number of the last snapshot that the browser got
        std::uint64_t version = 0;         // value of version_ in this snapshot; 0: the browser needs a new frame
        std::uint64_t sent = 0, seen = 0;  // numbers of the last frames sent and acknowledged
        std::vector<BodyHandle> bodies;    // copy of LiveEncoder::bodies of its stream
        std::thread thread;

        bool is_ready() const { return sent - seen < 2; }
    };

    Client* find(std::uint64_t client);
    void put_text(Client& client, const std::string& text);
    void note_busy();
    bool has_frame_for(const Client& client) const;
    void serve(Client& client);

    mutable std::mutex mutex_;  // protects all members below, except atomics
    std::condition_variable changed_;
    std::list<Client> clients_;
    std::uint64_t last_client_ = 0;
    bool closed_ = false;
    std::vector<LiveCommand> commands_;
    LiveRunInfo info_;
    LiveState state_;
    std::string failure_;  // reason why the run is paused by a failed step; empty if it is not
    std::uint64_t run_ = 0, version_ = 0, last_snapshot_ = 0;
    std::vector<std::shared_ptr<Snapshot>> snapshots_;  // all snapshots; a snapshot in use has further owners
    std::shared_ptr<Snapshot> latest_;

    std::atomic<bool> busy_ = false, commands_waiting_ = false;
    std::atomic<std::uint64_t> sent_ = 0, dropped_ = 0;
};

}  // namespace skerry
