// Rules by which the server of a live view admits or refuses a request.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace skerry {

/// The parts of a request on which its admission depends.
struct LiveRequest {
    std::string_view method, path, query;
    std::vector<std::string_view> hosts, origins;  // values of all headers Host and Origin
    bool upgrade = false;                          // true if the request asks for a WebSocket
};

enum class Admission {
    refused,
    page,    // the page, which contains nothing about the run
    stream,  // the WebSocket
};

/// Admits the page at /, and the stream at /live?token=TOKEN.
/// - Both need the Host 127.0.0.1:PORT or localhost:PORT, so that a foreign name that resolves to this machine is
///   refused.
/// - An Origin header, if there is one, must name the same host. The stream needs an Origin.
/// - The stream needs the token.
/// Pages of other sites fail because of Host and Origin, and other users of the machine because of the token.
Admission admission(const LiveRequest& request, int port, std::string_view token);

/// Returns 128 random bits from the operating system as 32 hexadecimal digits.
std::string random_token();

}  // namespace skerry
