#include <unistd.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/live/live_run.h"
#include "engine/live/server/live_server.h"
#include "skerry/live.h"

namespace skerry {

struct LiveView::Impl {
    LiveRun run;
    std::mutex closing;
    std::unique_ptr<LiveServer> server;  // none after close()
    std::string address;
    std::atomic<bool> open = true;
    pid_t process = getpid();

    /// True in a process made by fork(), in which the threads of the view do not exist and its locks may be held.
    bool lost_threads() const { return getpid() != process; }

    Impl(World& world, const LiveSettings& settings)
        : run(world, settings),
          server(std::make_unique<LiveServer>(settings.port, run.hub())),
          address(server->address()) {}
};

LiveView::LiveView(World& world, const LiveSettings& settings) {
    constexpr int last_port = 65535;
    if (settings.port < 0 || settings.port > last_port)
        refuse("live view", "port", std::to_string(settings.port), "a port from 0 to " + std::to_string(last_port),
               "0: a free port");
    impl_ = std::make_unique<Impl>(world, settings);
}

LiveView::~LiveView() {
    // In a process made by fork() the view is left in memory, because its destructor would wait for threads that do not
    // exist there.
    if (impl_ && impl_->lost_threads()) [[maybe_unused]]
        const Impl* left = impl_.release();
}

LiveView::LiveView(LiveView&&) noexcept = default;

LiveView& LiveView::operator=(LiveView&& other) noexcept {
    LiveView taken(std::move(other));
    std::swap(impl_, taken.impl_);
    return *this;
}

std::string LiveView::address() const {
    return impl_->address;
}

void LiveView::sync(World& world) {
    if (is_open())
        impl_->run.sync(world);
    else
        impl_->run.end_pulls(world);
}

Real LiveView::due(World& world) {
    if (is_open()) return impl_->run.due(world);
    impl_->run.end_pulls(world);
    return 0;
}

bool LiveView::between_steps(const World& world) {
    return !is_open() || impl_->run.between_steps(world);
}

void LiveView::fail(const std::string& text) {
    if (is_open()) impl_->run.fail(text);
}

void LiveView::refuse_resets(const std::string& reason) {
    impl_->run.refuse_resets(reason);
}

void LiveView::run(World& world, const std::function<bool()>& go_on,
                   const std::function<void(const std::string&)>& failed) {
    while (is_open() && go_on()) {
        const Real length = due(world);
        if (length == 0) continue;
        std::string problem;
        try {
            const StepReport report =
                world.advance(length, [&](const StepReport&) { return go_on() && between_steps(world); });
            if (!report.ok() && report.status != StepStatus::stopped) problem = report.message();
        } catch (const SceneError& error) {  // for example overlaps that the settings of the world refuse
            problem = error.what();
        }
        if (problem.empty()) continue;
        fail(problem);
        if (failed) failed(problem);
    }
    if (!is_open()) impl_->run.end_pulls(world);
}

void LiveView::close() {
    impl_->open = false;
    if (impl_->lost_threads()) return;
    const std::lock_guard lock(impl_->closing);
    impl_->server = nullptr;
}

bool LiveView::is_open() const {
    return impl_->open;
}

bool LiveView::playing() const {
    return !impl_->lost_threads() && impl_->run.playing();
}

int LiveView::clients() const {
    return impl_->lost_threads() ? 0 : impl_->run.hub().clients();
}

std::uint64_t LiveView::frames_sent() const {
    return impl_->run.hub().frames_sent();
}

std::uint64_t LiveView::frames_dropped() const {
    return impl_->run.hub().frames_dropped();
}

std::uint64_t LiveView::resets() const {
    return impl_->run.resets();
}

}  // namespace skerry
