#include "tests/ranks/thread_ranks.h"

#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace skerry::test {

namespace {

/// Thrown on all other ranks when a rank has failed.
struct OtherRankFailed : std::runtime_error {
    OtherRankFailed() : std::runtime_error("another rank failed") {}
};

/// Mail of all ranks.
class PostOffice {
public:
    explicit PostOffice(int count) : count_(count) {}

    int count() const { return count_; }
    void send(int from, int to, RankMessage message) {
        const std::scoped_lock lock(mutex_);
        box_[{from, to}].push_back(std::move(message));
        changed_.notify_all();
    }
    RankMessage receive(int from, int to) {
        std::unique_lock lock(mutex_);
        std::deque<RankMessage>& box = box_[{from, to}];
        changed_.wait(lock, [&] { return failed_ || !box.empty(); });
        if (failed_) throw OtherRankFailed();
        RankMessage message = std::move(box.front());
        box.pop_front();
        return message;
    }
    void fail() {
        const std::scoped_lock lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }

private:
    int count_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::pair<int, int>, std::deque<RankMessage>> box_;  // by sender and receiver
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
            office_.send(rank_, peers[i], out[i]);
        }
        for (std::size_t i = 0; i < peers.size(); ++i) in[i] = office_.receive(peers[i], rank_);
    }
    void reduce(std::span<std::byte> record, void (*combine)(std::byte*, const std::byte*)) override {
        ++traffic_.reductions;
        const std::vector<RankMessage> all = everything(record);
        std::memcpy(record.data(), all.front().data(), record.size());
        for (std::size_t r = 1; r < all.size(); ++r) combine(record.data(), all[r].data());
    }
    std::vector<RankMessage> gather_everywhere(std::span<const std::byte> mine) override {
        ++traffic_.collectives;
        return everything(mine);
    }
    std::vector<RankMessage> gather(std::span<const std::byte> mine) override {
        ++traffic_.collectives;
        std::vector<RankMessage> all = everything(mine);
        if (rank_ != 0) all.clear();
        return all;
    }
    [[noreturn]] void abort(std::string_view message, int code) override {
        throw std::runtime_error("rank " + std::to_string(rank_) + " ends with code " + std::to_string(code) + ": " +
                                 std::string(message));
    }

private:
    std::vector<RankMessage> everything(std::span<const std::byte> mine) {
        for (int r = 0; r < size(); ++r) office_.send(rank_, r, RankMessage(mine.begin(), mine.end()));
        std::vector<RankMessage> all;
        for (int r = 0; r < size(); ++r) all.push_back(office_.receive(r, rank_));
        return all;
    }

    PostOffice& office_;
    int rank_;
};

}  // namespace

void run_on_ranks(int count, const std::function<void(Ranks&)>& run) {
    PostOffice office(count);
    std::vector<std::exception_ptr> failure(static_cast<std::size_t>(count));
    const auto run_rank = [&](int rank) {
        ThreadRanks ranks(office, rank);
        try {
            run(ranks);
        } catch (...) {
            failure[static_cast<std::size_t>(rank)] = std::current_exception();
            office.fail();
        }
    };
    std::vector<std::thread> others;
    for (int rank = 1; rank < count; ++rank) others.emplace_back(run_rank, rank);
    run_rank(0);
    for (std::thread& other : others) other.join();
    std::exception_ptr first;
    for (const std::exception_ptr& thrown : failure) {
        if (!thrown) continue;
        try {
            std::rethrow_exception(thrown);
        } catch (const OtherRankFailed&) {
            if (!first) first = thrown;
        } catch (...) {
            std::rethrow_exception(thrown);
        }
    }
    if (first) std::rethrow_exception(first);
}

}  // namespace skerry::test
