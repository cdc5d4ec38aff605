// HTTP server of a live view, on the loopback address.
#pragma once

#include <memory>
#include <string>

#include "engine/live/hub.h"

namespace skerry {

/// Serves the page, and connects browsers to the hub by WebSockets. Its threads call join(), receive() and leave() of
/// the hub.
class LiveServer {
public:
    /// Throws SceneError if the port is in use or cannot be opened, or if this build has no three.js.
    LiveServer(int port, LiveHub& hub);
    /// Closes the hub, and stops the server.
    ~LiveServer();
    LiveServer(const LiveServer&) = delete;
    LiveServer& operator=(const LiveServer&) = delete;

    std::string address() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
