#include "engine/live/hub.h"

#include <algorithm>
#include <utility>

#include "skerry/error.h"

namespace skerry {

namespace {

/// True if a command makes an earlier one of the same browser unnecessary.
bool replaces(const LiveCommand& command, const LiveCommand& earlier) {
    return command.action == earlier.action && command.client == earlier.client &&
           (command.action == LiveAction::move ||
            (command.action == LiveAction::slider && command.number == earlier.number));
}

}  // namespace

LiveHub::~LiveHub() {
    close();
    for (Client& client : clients_)
        if (client.thread.joinable()) client.thread.join();
}

std::uint64_t LiveHub::join(LiveLink& link) {
    std::unique_lock lock(mutex_);
    if (closed_) return 0;
    if (clients_.size() == most_clients) {
        lock.unlock();
        link.send_text(problem_text("found " + std::to_string(most_clients) +
                                    " browsers connected to this live view, expected fewer; close one of them"));
        return 0;
    }
    Client& client = clients_.emplace_back();
    client.number = ++last_client_;
    client.link = &link;
    // The last snapshot counts as already sent to the new browser, because it may be outdated. The first frame of this
    // browser thus comes from a later snapshot.
    client.snapshot = last_snapshot_;
    if (!failure_.empty()) put_text(client, problem_text(failure_));
    client.thread = std::thread([this, &client] { serve(client); });
    note_busy();
    return client.number;
}

void LiveHub::leave(std::uint64_t number) {
    std::thread thread;
    {
        const std::lock_guard lock(mutex_);
        Client* client = find(number);
        if (!client) return;
        client->closed = true;
        thread = std::move(client->thread);
    }
    changed_.notify_all();
    thread.join();
    const std::lock_guard lock(mutex_);
    if (find(number)->pulls) commands_.push_back({.action = LiveAction::release, .client = number});
    std::erase_if(clients_, [&](const Client& client) { return client.number == number; });
    note_busy();
    changed_.notify_all();
}

void LiveHub::receive(std::uint64_t number, std::string_view text) {
    LiveCommand command;
    std::string problem;
    try {
        command = read_command(text);
    } catch (const SceneError& error) {
        problem = error.what();
    }
    const std::lock_guard lock(mutex_);
    Client* client = find(number);
    if (!client || client->closed) return;
    command.client = number;
    if (problem.empty() && command.action == LiveAction::seen) {
        if (command.number <= client->sent) client->seen = std::max(client->seen, command.number);
    } else if (problem.empty() && command.action == LiveAction::fields) {
        client->requested_content = command.content;
        client->version = 0;  // the present state is sent again, with the fields that the browser now requests
    } else if (problem.empty()) {
        if (command.action == LiveAction::pull) {
            if (command.body_number < client->bodies.size())
                command.body = client->bodies[command.body_number];
            else
                problem = "command: body: found " + std::to_string(command.body_number) + ", expected one of the " +
                          std::to_string(client->bodies.size()) + " bodies that this browser has received";
        }
        if (problem.empty() && !commands_.empty() && replaces(command, commands_.back()))
            commands_.back() = command;
        else if (problem.empty() && commands_.size() < most_waiting)
            commands_.push_back(command);
        else if (problem.empty())
            problem = "command: found " + std::to_string(most_waiting) +
                      " waiting commands, expected fewer; send the command again later";
        if (problem.empty() && command.action == LiveAction::pull) client->pulls = true;
        if (problem.empty() && command.action == LiveAction::release) client->pulls = false;
        note_busy();
    }
    if (!problem.empty()) put_text(*client, problem_text(problem));
    changed_.notify_all();
}

std::vector<LiveCommand> LiveHub::take_commands() {
    const std::lock_guard lock(mutex_);
    std::vector<LiveCommand> commands = std::exchange(commands_, {});
    note_busy();
    return commands;
}

void LiveHub::begin_run(const LiveRunInfo& info, const LiveState& state) {
    const std::lock_guard lock(mutex_);
    info_ = info;
    state_ = state;
    ++run_;
    ++version_;
    latest_ = nullptr;
    failure_.clear();
    changed_.notify_all();
}

void LiveHub::set_state(const LiveState& state) {
    const std::lock_guard lock(mutex_);
    if (state == state_) return;
    state_ = state;
    if (state.playing) failure_.clear();
    for (Client& client : clients_) put_text(client, state_text(state));
    changed_.notify_all();
}

void LiveHub::report(std::uint64_t number, const std::string& problem) {
    const std::lock_guard lock(mutex_);
    if (Client* client = find(number)) put_text(*client, problem_text(problem));
    changed_.notify_all();
}

void LiveHub::report_failure(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    failure_ = reason;
    for (Client& client : clients_) put_text(client, problem_text(reason));
    changed_.notify_all();
}

void LiveHub::mark_changed() {
    const std::lock_guard lock(mutex_);
    ++version_;
}

LiveHub::FrameRequest LiveHub::requested_frame() {
    const std::lock_guard lock(mutex_);
    FrameRequest request;
    for (const Client& client : clients_) {
        if (client.closed || client.version == version_) continue;
        if (!client.is_ready()) {
            dropped_.fetch_add(1, std::memory_order_relaxed);
            continue;
        }
        request.frame = true;
        request.content = std::max(request.content, client.requested_content);
    }
    return request;
}

std::shared_ptr<Snapshot> LiveHub::free_snapshot() {
    const std::lock_guard lock(mutex_);
    const auto is_free = [](const std::shared_ptr<Snapshot>& snapshot) { return snapshot.use_count() == 1; };
    const auto free_snapshot = std::ranges::find_if(snapshots_, is_free);
    return free_snapshot != snapshots_.end() ? *free_snapshot : snapshots_.emplace_back(std::make_shared<Snapshot>());
}

void LiveHub::publish(std::shared_ptr<Snapshot> snapshot) {
    const std::lock_guard lock(mutex_);
    snapshot->number = ++last_snapshot_;
    snapshot->run = run_;
    snapshot->version = version_;
    latest_ = std::move(snapshot);
    changed_.notify_all();
}

void LiveHub::wait_for_commands(std::chrono::steady_clock::time_point end) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, end, [&] { return !commands_.empty() || closed_; });
}

void LiveHub::close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    for (Client& client : clients_) client.closed = true;
    changed_.notify_all();
}

LiveState LiveHub::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

int LiveHub::clients() const {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(clients_.size());
}

LiveHub::Client* LiveHub::find(std::uint64_t number) {
    const auto found = std::ranges::find(clients_, number, &Client::number);
    return found == clients_.end() ? nullptr : &*found;
}

/// Appends a message. Drops a browser with `most_waiting` messages, so that messages to a hanging browser do not pile
/// up.
void LiveHub::put_text(Client& client, const std::string& text) {
    if (client.texts.size() < most_waiting)
        client.texts.push_back(text);
    else
        client.closed = true;
}

void LiveHub::note_busy() {
    commands_waiting_.store(!commands_.empty(), std::memory_order_relaxed);
    busy_.store(!commands_.empty() || !clients_.empty(), std::memory_order_relaxed);
}

bool LiveHub::has_frame_for(const Client& client) const {
    return latest_ && client.run == run_ && latest_->number > client.snapshot && client.is_ready();
}

/// Runs on the thread of a browser, and sends it messages until it is closed.
void LiveHub::serve(Client& client) {
    LiveEncoder encoder;
    std::shared_ptr<Snapshot> snapshot;
    std::unique_lock lock(mutex_);
    bool connected = true, outgrown = false;
    while (connected) {
        changed_.wait(lock, [&] {
            return client.closed || client.run != run_ || !client.texts.empty() || has_frame_for(client);
        });
        if (client.closed) break;
        if (client.run != run_) {
            client.run = run_;
            client.seen = client.sent;  // frames of the earlier run need no acknowledgement
            client.version = 0;
            client.bodies.clear();
            encoder = {};
            const std::string text = begin_text(info_, state_);
            lock.unlock();
            connected = client.link->send_text(text);
        } else if (!client.texts.empty()) {
            const std::string text = std::move(client.texts.front());
            client.texts.pop_front();
            lock.unlock();
            connected = client.link->send_text(text);
        } else {
            snapshot = latest_;
            client.snapshot = snapshot->number;
            client.version = snapshot->version;
            const std::uint64_t frame = ++client.sent;
            lock.unlock();
            const LiveEncoder::Messages messages = encoder.pack(*snapshot, frame, client.number);
            if (!messages.added.empty()) {
                const std::lock_guard again(mutex_);
                client.bodies.assign(encoder.bodies().begin(), encoder.bodies().end());
            }
            connected = (messages.added.empty() || client.link->send_text(messages.added)) &&
                        client.link->send_text(messages.row) && client.link->send_bytes(messages.changes);
            if (connected) sent_.fetch_add(1, std::memory_order_relaxed);
            outgrown = encoder.is_outgrown(*snapshot);
        }
        lock.lock();
        if (std::exchange(outgrown, false)) client.run = 0;  // run_ is at least 1, so the next turn starts a new stream
        // The snapshot is released only here, after this thread has read it completely, and while the mutex is locked.
        // free_snapshot() therefore never returns a snapshot that a thread still reads.
        snapshot.reset();
    }
    client.closed = true;
    lock.unlock();
    client.link->close();
}

}  // namespace skerry
