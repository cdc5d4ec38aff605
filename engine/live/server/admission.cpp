#include "engine/live/server/admission.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <system_error>

namespace skerry {

namespace {

/// Compares two texts in a time that depends on their lengths only, so that the time of a refusal does not depend on
/// the token.
bool equal_texts(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned different = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
    return different == 0;
}

}  // namespace

Admission admission(const LiveRequest& request, int port, std::string_view token) {
    const std::string suffix = ":" + std::to_string(port);
    if (request.method != "GET" || request.hosts.size() != 1 || request.origins.size() > 1) return Admission::refused;
    const std::string_view host = request.hosts.front();
    if (host != "127.0.0.1" + suffix && host != "localhost" + suffix) return Admission::refused;
    const bool own_origin = !request.origins.empty() && request.origins.front() == "http://" + std::string(host);
    if (!request.origins.empty() && !own_origin) return Admission::refused;
    if (!request.upgrade) return request.path == "/" ? Admission::page : Admission::refused;
    const bool known =
        request.path == "/live" && own_origin && equal_texts(request.query, "token=" + std::string(token));
    return known ? Admission::stream : Admission::refused;
}

std::string random_token() {
    std::array<std::uint8_t, 16> bytes;
    if (getentropy(bytes.data(), bytes.size()) != 0)
        throw std::system_error(errno, std::generic_category(), "random numbers of the system");
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

}  // namespace skerry
