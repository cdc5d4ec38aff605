#include "jobs/ranks/mpi_ranks.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

// Excludes the C++ interface of MPI, which newer versions of MPI do not have and which needs another library.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

namespace skerry {

namespace {

/// Adds the wall time from its construction to its destruction to a sum.
class Stopclock {
public:
    explicit Stopclock(double& seconds) : seconds_(seconds) {}
    ~Stopclock() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
    Stopclock(const Stopclock&) = delete;
    Stopclock& operator=(const Stopclock&) = delete;

private:
    double& seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Function that combines two records in the present reduction. reduce() sets it. It is global, because MPI passes no
/// argument of the caller to an MPI_User_function.
void (*combine_in_use)(std::byte*, const std::byte*) = nullptr;

/// Combines arrays of records by combine_in_use. It has the type MPI_User_function.
void combine_records(void* from, void* into, int* count, MPI_Datatype* type) {
    MPI_Aint begin = 0, size = 0;
    MPI_Type_get_extent(*type, &begin, &size);
    for (int i = 0; i < *count; ++i)
        combine_in_use(static_cast<std::byte*>(into) + i * size, static_cast<const std::byte*>(from) + i * size);
}

class MpiRanks final : public Ranks {
public:
    MpiRanks(MPI_Comm world, bool ends_mpi, std::atomic<const char*>* exit_message)
        : ends_mpi_(ends_mpi), exit_message_(exit_message) {
        int level = MPI_THREAD_SINGLE;
        MPI_Query_thread(&level);
        if (level < MPI_THREAD_SERIALIZED)
            throw std::runtime_error("MPI: found the thread level " + std::to_string(level) + ", expected at least " +
                                     std::to_string(MPI_THREAD_SERIALIZED) +
                                     " (MPI_THREAD_SERIALIZED); call MPI_Init_thread with this level");
        MPI_Comm_dup(world, &world_);
        MPI_Comm_rank(world_, &rank_);
        MPI_Comm_size(world_, &size_);
        MPI_Op_create(combine_records, 1, &combine_);
    }
    ~MpiRanks() override {
        for (auto& [bytes, type] : record_types_) MPI_Type_free(&type);
        MPI_Op_free(&combine_);
        MPI_Comm_free(&world_);
        if (ends_mpi_) MPI_Finalize();
    }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    int rank() const override { return rank_; }
    int size() const override { return size_; }
    void exchange(std::span<const int> peers, std::span<const RankMessage> out, std::span<RankMessage> in) override {
        const Stopclock clock(traffic_.seconds);
        ++traffic_.exchanges;
        sends_.clear();
        for (std::size_t i = 0; i < peers.size(); ++i) {
            ++traffic_.messages;
            traffic_.bytes += out[i].size();
            send_pieces(out[i], peers[i]);
        }
        for (std::size_t i = 0; i < peers.size(); ++i) receive_pieces(peers[i], in[i]);
        MPI_Waitall(static_cast<int>(sends_.size()), sends_.data(), MPI_STATUSES_IGNORE);
    }
    void reduce(std::span<std::byte> record, void (*combine)(std::byte*, const std::byte*)) override {
        const Stopclock clock(traffic_.seconds);
        ++traffic_.reductions;
        const auto [type, is_new] = record_types_.try_emplace(record.size(), MPI_DATATYPE_NULL);
        if (is_new) {
            MPI_Type_contiguous(length_of(record.size(), "a record"), MPI_BYTE, &type->second);
            MPI_Type_commit(&type->second);
        }
        combine_in_use = combine;
        MPI_Allreduce(MPI_IN_PLACE, record.data(), 1, type->second, combine_, world_);
    }
    std::vector<RankMessage> gather_everywhere(std::span<const std::byte> own_message) override {
        const Stopclock clock(traffic_.seconds);
        ++traffic_.collectives;
        const int length = length_of(own_message.size(), "a gathered message");
        std::vector<int> lengths(static_cast<std::size_t>(size_)), begins(static_cast<std::size_t>(size_));
        MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, world_);
        std::size_t total = 0;
        for (std::size_t r = 0; r < lengths.size(); ++r) {
            begins[r] = length_of(total, "the gathered messages");
            total += static_cast<std::size_t>(lengths[r]);
        }
        RankMessage joined(total);
        MPI_Allgatherv(own_message.data(), length, MPI_BYTE, joined.data(), lengths.data(), begins.data(), MPI_BYTE,
                       world_);
        std::vector<RankMessage> all;
        for (std::size_t r = 0; r < lengths.size(); ++r)
            all.emplace_back(joined.begin() + begins[r], joined.begin() + begins[r] + lengths[r]);
        return all;
    }
    std::vector<RankMessage> gather(std::span<const std::byte> own_message) override {
        const Stopclock clock(traffic_.seconds);
        ++traffic_.collectives;
        const std::uint64_t bytes = own_message.size();
        std::vector<std::uint64_t> lengths(rank_ == 0 ? static_cast<std::size_t>(size_) : 0);
        MPI_Gather(&bytes, 1, MPI_UINT64_T, lengths.data(), 1, MPI_UINT64_T, 0, world_);
        std::vector<RankMessage> all;
        if (rank_ == 0) {
            all.emplace_back(own_message.begin(), own_message.end());
            for (int r = 1; r < size_; ++r) {
                RankMessage& message = all.emplace_back(lengths[static_cast<std::size_t>(r)]);
                for_each_piece(message.size(), [&](std::size_t begin, int length) {
                    MPI_Recv(message.data() + begin, length, MPI_BYTE, r, gather_tag, world_, MPI_STATUS_IGNORE);
                });
            }
        } else {
            for_each_piece(own_message.size(), [&](std::size_t begin, int length) {
                MPI_Send(own_message.data() + begin, length, MPI_BYTE, 0, gather_tag, world_);
            });
        }
        return all;
    }
    [[noreturn]] void abort(std::string_view message, int code) override {
        std::array<char, MPI_MAX_PROCESSOR_NAME> host{};
        int length = 0;
        MPI_Get_processor_name(host.data(), &length);
        std::cerr << "skerry: rank " << rank_ << " on " << host.data() << ": " << message << "\n";
        if (const char* const words = exit_message_ == nullptr ? nullptr : exit_message_->exchange(nullptr))
            std::cerr << words;
        std::cerr << std::flush;
        MPI_Abort(world_, code);
        std::exit(code);
    }

private:
    static constexpr int exchange_tag = 1, gather_tag = 2;
    // A message is sent in pieces of this length [bytes]. The first shorter piece, which may be empty, ends the
    // message.
    static constexpr std::size_t longest_piece = std::size_t{1} << 24;

    /// Converts a number of bytes to int, the type in which MPI counts. Throws std::runtime_error if it does not fit.
    int length_of(std::size_t bytes, const std::string& object) const {
        constexpr int max_count = std::numeric_limits<int>::max();
        if (bytes > max_count)
            throw std::runtime_error("rank " + std::to_string(rank_) + ": found " + object + " of " +
                                     std::to_string(bytes) + " bytes, expected at most " + std::to_string(max_count) +
                                     "; use more ranks");
        return static_cast<int>(bytes);
    }
    void send_pieces(const RankMessage& message, int to) {
        std::size_t begin = 0, length = longest_piece;
        for (; length == longest_piece; begin += length) {
            length = std::min(longest_piece, message.size() - begin);
            MPI_Isend(message.data() + begin, static_cast<int>(length), MPI_BYTE, to, exchange_tag, world_,
                      &sends_.emplace_back());
        }
    }
    void receive_pieces(int from, RankMessage& message) {
        std::size_t begin = 0, length = longest_piece;
        for (; length == longest_piece; begin += length) {
            MPI_Message piece{};
            MPI_Status status{};
            int count = 0;
            MPI_Mprobe(from, exchange_tag, world_, &piece, &status);
            MPI_Get_count(&status, MPI_BYTE, &count);
            length = static_cast<std::size_t>(count);
            message.resize(begin + length);
            MPI_Mrecv(message.data() + begin, count, MPI_BYTE, &piece, MPI_STATUS_IGNORE);
        }
    }

    /// Calls act(begin, length) for consecutive pieces of a message, none longer than 2^30 bytes, because MPI counts
    /// with an int.
    template <class Act>
    static void for_each_piece(std::size_t bytes, Act act) {
        constexpr std::size_t longest = std::size_t{1} << 30;  // [bytes]
        for (std::size_t begin = 0; begin < bytes; begin += longest)
            act(begin, static_cast<int>(std::min(longest, bytes - begin)));
    }

    bool ends_mpi_;
    std::atomic<const char*>* exit_message_;
    MPI_Comm world_ = MPI_COMM_NULL;
    int rank_ = 0, size_ = 1;
    MPI_Op combine_ = MPI_OP_NULL;
    std::map<std::size_t, MPI_Datatype> record_types_;  // types of the records of reductions, by their size [bytes]
    std::vector<MPI_Request> sends_;
};

}  // namespace

std::unique_ptr<Ranks> start_mpi(std::atomic<const char*>* exit_message) {
    // With this variable Open MPI yields the core while it waits. Otherwise a waiting rank would take time from the
    // threads of other ranks. setenv() keeps a value that the user has set.
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
    int level = MPI_THREAD_SINGLE;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
    return std::make_unique<MpiRanks>(MPI_COMM_WORLD, true, exit_message);
}

std::unique_ptr<Ranks> join_mpi(int communicator) {
    return std::make_unique<MpiRanks>(MPI_Comm_f2c(communicator), false, nullptr);
}

}  // namespace skerry
