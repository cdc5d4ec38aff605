// A live view: a page in the browser that shows a world while it is simulated, and that controls it (docs/view.md).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "skerry/recorder.h"
#include "skerry/slider.h"
#include "skerry/world.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Settings of a live view.
struct LiveSettings {
    std::string title = "Skerry";         // title of the page
    int port = 0;                         // TCP port from 0 to 65535; 0: a free port
    Real rate = 1;                        // simulated time per wall time, from 0 to 1000; 0: as fast as possible
    bool paused = false;                  // true: the view waits for the user to press play
    std::vector<Slider> sliders{};        // values that users may change
    std::vector<RecordedProbe> probes{};  // quantities that the page plots while the world runs
};

/// A server that shows a world to browsers on this machine:
///
/// - Access: the server listens on the loopback address only. A browser needs the token of address(), which is a new
///   random number for each view. Requests with another Host, Origin or token are refused.
/// - Threads: one thread advances the world and calls the functions of the view. Other threads encode and send the
///   frames. The simulation never waits for a browser: a slow browser gets fewer frames.
/// - Results: a browser that only displays the world changes no bit of its state.
/// - fork(): the server stays with the parent process. The child process can only close the view, which has no effect
///   on the server.
/// - SIGPIPE: when the first view is made, the process begins to ignore this signal, because a browser can end a
///   connection at any time.
class LiveView {
public:
    /// Starts the server, and stores the present state of the world for a reset. Throws SceneError if a setting is out
    /// of range, a probe or a slider names no object of the world, the port is in use, or this build has no live view.
    LiveView(World& world, const LiveSettings& settings);
    /// Closes the view.
    ~LiveView();
    LiveView(LiveView&&) noexcept;
    LiveView& operator=(LiveView&&) noexcept;

    // The following functions may be called by any thread.

    /// Address of the page, for example http://127.0.0.1:40123/#token=...
    std::string address() const;
    /// Ends all connections and stops the server. From then on sync(), due() and run() do nothing but release the
    /// bodies that browsers were pulling with the pointer, due() returns 0, and fail() has no effect.
    void close();
    /// False after close().
    bool is_open() const;
    // True if the view plays, false if it is paused. Exception: if a browser has requested a single step, true until
    // the next call of sync() or due(), so that the caller takes the step.
    bool playing() const;
    int clients() const;  // number of connected browsers
    /// Number of frames sent to browsers.
    std::uint64_t frames_sent() const;
    std::uint64_t frames_dropped() const;  // frames that a browser missed because it was still busy with earlier ones
    std::uint64_t resets() const;          // number of resets of the world

    // The following functions must be called between two calls of advance, except between_steps(), which is called
    // during a call. `world` is the world of the constructor; it may have been moved to another variable meanwhile.

    /// Carries out the commands that browsers have sent, and shows the world to browsers that are ready for a frame, at
    /// most 30 times a second of wall time. A command that fails changes nothing, and the browser that sent it gets the
    /// error.
    ///
    /// If the view is paused, the call then waits for the next command, at most 20 ms. If the view plays, the call
    /// never waits; without a browser it costs two comparisons.
    void sync(World& world);
    /// Does the work of sync(), and returns the simulated time by which the caller must advance the world now [s]:
    /// - the length of one step, if a browser has requested a single step,
    /// - 0, if the view is paused or the world is ahead of the wall clock; the call then first waits for commands, at
    ///   most 20 ms,
    /// - otherwise at most 1/60 s.
    Real due(World& world);
    /// Shows the world between two steps of a long call of World::advance. Call it in the callback `go_on` of
    /// advance(), and return its result: false if commands of browsers wait. advance() then ends, so that sync() can
    /// carry out the commands.
    bool between_steps(const World& world);
    /// Pauses the view, and shows the text to all browsers. Call it after a step that failed.
    void fail(const std::string& text);
    /// From now on refuses the resets that browsers request, and shows them the reason; an empty text allows resets
    /// again. Use it, for example, while a recorder runs: a reset moves the world back in time, where the recorder
    /// could not continue.
    void refuse_resets(const std::string& reason);
    /// Advances the world as the browsers ask, until `go_on` returns false. `go_on` is called before each step. One
    /// call of advance() covers at most 1/60 s of simulated time. A step that cannot be committed pauses the view;
    /// `failed` is then called with the error message.
    void run(World& world, const std::function<bool()>& go_on,
             const std::function<void(const std::string&)>& failed = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
