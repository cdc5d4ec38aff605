#include "engine/live/server/live_server.h"

#include <arpa/inet.h>
#include <civetweb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>
#include <thread>

#include "engine/base/complaint.h"
#include "engine/live/server/admission.h"
#include "engine/output/page/page_document.h"

namespace skerry {

namespace {

constexpr std::size_t longest_message = 4096;  // longest message of a browser [bytes]; commands are shorter than 300

/// The WebSocket of one browser.
class SocketLink final : public LiveLink {
public:
    SocketLink(mg_connection* connection, int socket) : connection_(connection), socket_(socket) {}

    bool send_text(std::string_view text) override { return send(MG_WEBSOCKET_OPCODE_TEXT, text); }
    bool send_bytes(std::string_view bytes) override { return send(MG_WEBSOCKET_OPCODE_BINARY, bytes); }
    /// Wakes the thread of the connection, which then ends it. mg_close_connection must not be called for this, because
    /// it can close the socket while that thread uses it, and does not wake a thread that waits for the rest of a
    /// message.
    void close() override {
        if (!broken_) send(MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, {});
        shutdown(socket_, SHUT_RDWR);
    }

    /// Ends the connection if the browser has sent nothing for 30 s. It has then left several pings unanswered, or
    /// stopped in the middle of a message, during which the library sends no pings.
    void close_if_silent() const {
        constexpr std::uint32_t longest_silence = 30'000;  // [ms]
        tcp_info info{};
        socklen_t size = sizeof info;
        if (getsockopt(socket_, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 && info.tcpi_last_data_recv > longest_silence)
            shutdown(socket_, SHUT_RDWR);
    }

    std::uint64_t client = 0;  // number of the browser at the hub

private:
    /// Sends a message. Returns false if only a part was sent, because the time limit for requests was reached or the
    /// connection is broken. Nothing more can be sent then, as the browser would read it as the rest of the message.
    bool send(int opcode, std::string_view bytes) {
        constexpr std::size_t header = 2;  // result of the library for a message without data: the length of its header
        mg_lock_connection(connection_);   // so that the library sends no ping after an incomplete message
        const int sent = mg_websocket_write(connection_, opcode, bytes.data(), bytes.size());
        broken_ = sent < 0 || static_cast<std::size_t>(sent) != (bytes.empty() ? header : bytes.size());
        if (broken_) shutdown(socket_, SHUT_RDWR);
        mg_unlock_connection(connection_);
        return !broken_;
    }

    mg_connection* connection_;
    int socket_;           // open until Impl::closed() returns
    bool broken_ = false;  // true if only a part of a message was sent
};

/// Calls a function for the C library, which no exception may enter. Returns `otherwise` if the function throws.
template <class Result, class Call>
Result guarded(Result otherwise, Call&& call) {
    try {
        return call();
    } catch (const std::exception&) {
        return otherwise;
    }
}

LiveRequest request_of(const mg_request_info& info) {
    const auto text = [](const char* part) { return part ? std::string_view(part) : std::string_view(); };
    LiveRequest request{.method = text(info.request_method),
                        .path = text(info.local_uri_raw),
                        .query = text(info.query_string),
                        .hosts = {},
                        .origins = {}};
    const auto is_named = [](std::string_view name, std::string_view wanted) {
        return std::ranges::equal(name, wanted, [](char a, char b) { return (a | 32) == (b | 32); });
    };
    for (int i = 0; i < info.num_headers; ++i) {
        const mg_header& header = info.http_headers[i];
        if (is_named(header.name, "host")) request.hosts.emplace_back(header.value);
        if (is_named(header.name, "origin")) request.origins.emplace_back(header.value);
        request.upgrade |= is_named(header.name, "upgrade");
    }
    return request;
}

/// Returns a port of a connected socket; 0 if `socket` is not connected or is no socket. `call`: getsockname for the
/// local port, getpeername for the remote port.
template <class Call>
int port_of(int socket, Call&& call) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    const bool is_known =
        call(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET;
    return is_known ? ntohs(address.sin_port) : 0;
}

/// Returns the socket of a connection; -1 if it is not found. The library has no function for this. `port`: port of the
/// server.
int socket_of(const mg_connection* connection, int port) {
    constexpr long most_sockets = 1 << 16;  // largest number of file descriptors to try
    const long limit = sysconf(_SC_OPEN_MAX);
    const int end = static_cast<int>(limit > 0 ? std::min(limit, most_sockets) : most_sockets);
    const int remote = mg_get_request_info(connection)->remote_port;
    for (int socket = 0; socket < end; ++socket)
        if (port_of(socket, getpeername) == remote && port_of(socket, getsockname) == port) return socket;
    return -1;
}

/// Connects to a port of this machine and closes the connection, to wake the thread that accepts connections there.
void connect_once(int port) {
    const int own = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (own < 0) return;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    static_cast<void>(connect(own, reinterpret_cast<const sockaddr*>(&address), sizeof address));
    ::close(own);
}

}  // namespace

struct LiveServer::Impl {
    LiveHub& hub;
    std::string page, token;
    std::atomic<int> port = 0;  // written once, before the first request can be admitted
    mg_context* context = nullptr;
    std::mutex links_mutex{};
    std::set<const SocketLink*> links{};  // links of the connected browsers; guarded by links_mutex

    static Impl& of(const mg_connection* connection) {
        return *static_cast<Impl*>(mg_get_user_context_data(connection));
    }
    static SocketLink* link_of(const mg_connection* connection) {
        return static_cast<SocketLink*>(mg_get_user_connection_data(connection));
    }
    void put_page(mg_connection* connection) const;
    void close_silent_links();
    static int begin_request(mg_connection* connection);
    static void ready(mg_connection* connection, void*);
    static int receive(mg_connection* connection, int bits, char* data, std::size_t size, void*);
    static void closed(const mg_connection* connection, void*);
};

void LiveServer::Impl::put_page(mg_connection* connection) const {
    const std::string sources = "ws://127.0.0.1:" + std::to_string(port) + " ws://localhost:" + std::to_string(port);
    mg_printf(connection,
              "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: %zu\r\n"
              "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
              "img-src data:; connect-src 'self' %s; frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n"
              "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
              "Connection: close\r\n\r\n",
              page.size(), sources.c_str());
    mg_write(connection, page.data(), page.size());
}

/// Closes connections that received no data for 30 s, because their browsers have probably gone. This makes room for
/// other browsers.
void LiveServer::Impl::close_silent_links() {
    const std::lock_guard lock(links_mutex);
    for (const SocketLink* link : links) link->close_if_silent();
}

/// Answers a request and returns the status of the answer. For a WebSocket returns 0, and the library continues.
int LiveServer::Impl::begin_request(mg_connection* connection) {
    constexpr int ok = 200, forbidden = 403;
    return guarded(forbidden, [&] {
        Impl& server = of(connection);
        switch (admission(request_of(*mg_get_request_info(connection)), server.port, server.token)) {
            case Admission::stream:
                return 0;
            case Admission::page:
                server.close_silent_links();
                server.put_page(connection);
                return ok;
            case Admission::refused:
                break;
        }
        mg_printf(connection, "HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
        return forbidden;
    });
}

void LiveServer::Impl::ready(mg_connection* connection, void*) {
    guarded(false, [&] {
        Impl& server = of(connection);
        const int socket = socket_of(connection, server.port);
        if (socket < 0) {
            mg_close_connection(connection);
            return false;
        }
        auto link = std::make_unique<SocketLink>(connection, socket);
        std::set<const SocketLink*> joined{link.get()};
        link->client = server.hub.join(*link);
        if (link->client == 0) {
            link->close();
            server.close_silent_links();  // makes room for the next attempt of the page to connect
            return false;
        }
        mg_set_user_connection_data(connection, link.release());
        const std::lock_guard lock(server.links_mutex);
        server.links.merge(joined);  // moves the node of `joined`, so it allocates nothing and cannot throw
        return true;
    });
}

int LiveServer::Impl::receive(mg_connection* connection, int bits, char* data, std::size_t size, void*) {
    constexpr int keep = 1, close = 0, final_text = 0x80 | MG_WEBSOCKET_OPCODE_TEXT;
    const SocketLink* link = link_of(connection);
    // Commands are text messages in one WebSocket frame. Browsers do not split messages as short as commands.
    if (!link || bits != final_text || size > longest_message) return close;
    return guarded(close, [&] {
        of(connection).hub.receive(link->client, {data, size});
        return keep;
    });
}

void LiveServer::Impl::closed(const mg_connection* connection, void*) {
    const std::unique_ptr<SocketLink> link(link_of(connection));
    guarded(false, [&] {
        if (!link) return false;
        Impl& server = of(connection);
        {
            const std::lock_guard lock(server.links_mutex);
            server.links.erase(link.get());
        }
        server.hub.leave(link->client);
        return true;
    });
}

LiveServer::LiveServer(int port, LiveHub& hub)
    : impl_(new Impl{.hub = hub, .page = live_page(), .token = random_token()}) {
    const std::string listening = "127.0.0.1:" + std::to_string(port);
    // Each connected browser occupies one thread. The remaining threads answer requests.
    const std::string threads = std::to_string(LiveHub::most_clients + 8);
    const char* options[] = {"listening_ports",
                             listening.c_str(),
                             "num_threads",
                             threads.c_str(),
                             "request_timeout_ms",
                             "10000",  // time limit for requests, and for a browser that takes no data [ms]
                             "websocket_timeout_ms",
                             "5000",  // silence after which a ping is sent to a browser [ms]
                             "enable_websocket_ping_pong",
                             "yes",
                             "tcp_nodelay",
                             "1",
                             "enable_directory_listing",
                             "no",
                             nullptr};
    mg_callbacks callbacks{};
    callbacks.begin_request = Impl::begin_request;
    callbacks.log_message = [](const mg_connection*, const char*) { return 1; };  // writes no log
    std::array<char, 256> text{};
    mg_init_data start{.callbacks = &callbacks, .user_data = impl_.get(), .configuration_options = options};
    mg_error_data error{.code = nullptr, .text = text.data(), .text_buffer_size = text.size()};
    impl_->context = mg_start2(&start, &error);
    if (!impl_->context)
        refuse("live view", "port", std::to_string(port) + ", which cannot be opened (" + text.data() + ")",
               "a free port, or 0 to choose one", "another program may use this port");
    mg_server_port ports{};
    mg_get_server_ports(impl_->context, 1, &ports);
    impl_->port = ports.port;
    mg_set_websocket_handler(impl_->context, "/live", nullptr, Impl::ready, Impl::receive, Impl::closed, nullptr);
}

LiveServer::~LiveServer() {
    impl_->hub.close();
    // The library's thread that accepts connections checks only every 2 s, and at each new connection, whether it has
    // to stop. Connections are therefore made until it has stopped.
    std::atomic<bool> stopped = false;
    std::thread stopping([&] {
        mg_stop(impl_->context);
        stopped = true;
    });
    while (!stopped) {
        connect_once(impl_->port);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    stopping.join();
}

std::string LiveServer::address() const {
    return "http://127.0.0.1:" + std::to_string(impl_->port) + "/#token=" + impl_->token;
}

}  // namespace skerry
