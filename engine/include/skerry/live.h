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

/// A server for browsers on this machine that shows a world. It listens on the loopback address only. A browser needs
/// the token of address(), a new random number for each view. Requests with another Host, Origin or token are refused.
///
/// One thread advances the world and calls the functions of the view. Other threads encode and send the frames. The
/// simulation never waits for a browser: a browser that is slow gets fewer frames. A browser that only displays the
/// world changes no bit of it. After fork(), the server stays with the parent process; the child process can only close
/// the view, which has no effect on the server. When the first view is made, the process begins to ignore the signal
/// SIGPIPE, because a browser can end a connection at any time.
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
    /// Ends all connections and stops the server. Afterwards sync(), due() and run() only release the bodies that
    /// browsers pull, due() returns 0, and fail() does nothing.
    void close();
    /// False after close().
    bool is_open() const;
    // false if the view is paused; a requested single step counts as playing until the next sync()
    bool playing() const;
    int clients() const;  // number of connected browsers
    /// Number of frames sent to browsers.
    std::uint64_t frames_sent() const;
    std::uint64_t frames_dropped() const;  // frames that a browser missed because it was still busy with earlier ones
    std::uint64_t resets() const;          // number of resets of the world

    // The following functions must be called between two calls of advance; only between_steps() is called within one.
    // `world` is the world of the constructor, which may have been moved to another variable meanwhile.

    /// Carries out the commands that browsers have sent, and shows the world to browsers that are ready for a frame, at
    /// most 30 times a second of wall time. Commands that fail are reported to the browser that sent them, and change
    /// nothing. While the view is paused the call then waits for the next command, at most 20 ms. Otherwise it never
    /// waits, and without a browser it costs two comparisons.
    void sync(World& world);
    /// Calls sync() and returns the simulated time that is to be advanced now [s]; 0 if the view is paused or the world
    /// is ahead of the wall clock. With the result 0 it waits for commands, at most 20 ms. The caller must advance the
    /// world by the result. For a single step the result is the length of one step.
    Real due(World& world);
    /// Call this in the callback `go_on` of World::advance, and return its result. It shows the world between two steps
    /// of a long call. It returns false if commands wait, so that the call ends and sync() can carry them out.
    bool between_steps(const World& world);
    /// Pauses the view, and shows the text to all browsers. Call it after a step that failed.
    void fail(const std::string& text);
    /// Refuses resets by browsers with this text, for example while a recorder could not continue at an earlier time.
    /// An empty text allows them again.
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
