#include "tests/ranks/thread_ranks.h"

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

namespace skerry::test {

namespace {

/// Thrown on all other ranks when a rank has failed. It is no std::exception, for which a rank would end all ranks.
struct OtherRankFailed {};

using Clock = std::chrono::steady_clock;

struct Letter {
    RankMessage message;
    const char* call;  // function of Ranks that sent it
    Clock::time_point arrival;
};

/// Mail of all ranks. A call that could never return throws an exception.
class PostOffice {
public:
    PostOffice(int count, std::chrono::microseconds delay)
        : count_(count), delay_(delay), sender_awaited_(static_cast<std::size_t>(count), nobody) {}

    int count() const { return count_; }
    void send(int from, int to, RankMessage message, const char* call) {
        const std::scoped_lock lock(mutex_);
        box_[{from, to}].push_back({std::move(message), call, Clock::now() + delay_});
        changed_.notify_all();
    }
    RankMessage receive(int from, int to, const char* call) {
        std::unique_lock lock(mutex_);
        std::deque<Letter>& box = box_[{from, to}];
        int& awaited = sender_awaited_[static_cast<std::size_t>(to)];
        awaited = from;
        if (box.empty()) require_no_deadlock(call);
        changed_.wait(lock, [&] { return failed_ || !box.empty(); });
        if (failed_) throw OtherRankFailed();
        awaited = nobody;
        const Letter letter = std::move(box.front());
        box.pop_front();
        if (std::string_view(letter.call) != call)
            throw std::runtime_error("rank " + std::to_string(to) + " waits in " + call + " for a message of rank " +
                                     std::to_string(from) + ", which called " + letter.call);
        lock.unlock();
        // A sleep would last 50 us longer.
        while (Clock::now() < letter.arrival) std::this_thread::yield();
        return letter.message;
    }
    /// Notes that a rank ended.
    void leave(int rank) {
        const std::scoped_lock lock(mutex_);
        sender_awaited_[static_cast<std::size_t>(rank)] = gone;
        if (!failed_) require_no_deadlock("a call that some rank did not make");
    }
    void fail() {
        const std::scoped_lock lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }

private:
    static constexpr int nobody = -1, gone = -2;

    /// Throws if each rank has ended or waits for a message that was not sent.
    void require_no_deadlock(const char* call) {
        std::string waiting;
        for (int rank = 0; rank < count_; ++rank) {
            const int from = sender_awaited_[static_cast<std::size_t>(rank)];
            if (from == gone) continue;
            if (from == nobody || !box_[{from, rank}].empty()) return;
            waiting += ", rank " + std::to_string(rank) + " for rank " + std::to_string(from);
        }
        if (!waiting.empty()) throw std::runtime_error(std::string("all ranks wait in ") + call + waiting);
    }

    int count_;
    std::chrono::microseconds delay_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::pair<int, int>, std::deque<Letter>> box_;  // by sender and receiver
    std::vector<int> sender_awaited_;                        // by receiver; nobody: it does not wait
    bool failed_ = false;
};

class ThreadRanks final : public Ranks {
public:
    ThreadRanks(PostOffice& office, int rank) : office_(office), rank_(rank) {}

    int rank() const override { return rank_; }
    int size() const override { return office_.count(); }
    void exchange(std::span<const int> peers, std::span<const RankMessage> out, std::span<RankMessage> in) override {
        ++traffic_.exchanges;
        for (std::size_t i = 0; i < peers.size(); ++i) {
            ++traffic_.messages;
            traffic_.bytes += out[i].size();
            office_.send(rank_, peers[i], out[i], "exchange");
        }
        for (std::size_t i = 0; i < peers.size(); ++i) in[i] = office_.receive(peers[i], rank_, "exchange");
    }
    void reduce(std::span<std::byte> record, void (*combine)(std::byte*, const std::byte*)) override {
        ++traffic_.reductions;
        const std::vector<RankMessage> all = everything(record, "reduce");
        std::memcpy(record.data(), all.front().data(), record.size());
        for (std::size_t r = 1; r < all.size(); ++r) combine(record.data(), all[r].data());
    }
    std::vector<RankMessage> gather_everywhere(std::span<const std::byte> own_message) override {
        ++traffic_.collectives;
        return everything(own_message, "gather_everywhere");
    }
    std::vector<RankMessage> gather(std::span<const std::byte> own_message) override {
        ++traffic_.collectives;
        std::vector<RankMessage> all = everything(own_message, "gather");
        if (rank_ != 0) all.clear();
        return all;
    }
    [[noreturn]] void abort(std::string_view message, int code) override {
        throw std::runtime_error("rank " + std::to_string(rank_) + " ends with code " + std::to_string(code) + ": " +
                                 std::string(message));
    }

private:
    std::vector<RankMessage> everything(std::span<const std::byte> own_message, const char* call) {
        for (int r = 0; r < size(); ++r)
            office_.send(rank_, r, RankMessage(own_message.begin(), own_message.end()), call);
        std::vector<RankMessage> all;
        for (int r = 0; r < size(); ++r) all.push_back(office_.receive(r, rank_, call));
        return all;
    }

    PostOffice& office_;
    int rank_;
};

}  // namespace

void run_on_ranks(int count, const std::function<void(Ranks&)>& run, std::chrono::microseconds delay) {
    PostOffice office(count, delay);
    std::vector<std::exception_ptr> failure(static_cast<std::size_t>(count));
    const auto run_rank = [&](int rank) {
        ThreadRanks ranks(office, rank);
        try {
            run(ranks);
            office.leave(rank);
        } catch (...) {
            failure[static_cast<std::size_t>(rank)] = std::current_exception();
            office.fail();
        }
    };
    std::vector<std::thread> others;
    for (int rank = 1; rank < count; ++rank) others.emplace_back(run_rank, rank);
    run_rank(0);
    for (std::thread& other : others) other.join();
    for (const std::exception_ptr& thrown : failure) {
        if (!thrown) continue;
        try {
            std::rethrow_exception(thrown);
        } catch (const OtherRankFailed&) {
            continue;  // the rank that failed first has thrown another exception
        }
    }
}

}  // namespace skerry::test
