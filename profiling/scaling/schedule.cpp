#include "profiling/scaling/schedule.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <vector>

#include "jobs/team.h"

namespace skerry::profiling {

namespace {

constexpr int nobody = -1;

/// Factor by which a block takes longer than alone while `busy` of `cores` cores work.
class Slowdown {
public:
    Slowdown(int cores, const MachineModel& machine, const Traffic& traffic)
        : demand_(traffic.bytes_per_second), bandwidth_(machine.bandwidth) {
        const int chiplets = (cores + machine.cores_per_chiplet - 1) / machine.cores_per_chiplet;
        in_caches_ = traffic.working_set <= chiplets * machine.cache_per_chiplet;
        // Every core is assumed to have written an equal part of the data that a block reads.
        const double elsewhere = 1 - 1.0 / cores, far = 1 - 1.0 / chiplets;
        moved_ = demand_ * ((elsewhere - far) / machine.near_rate + far / machine.far_rate);
        moved_of_own_ = machine.own_from_elsewhere * moved_;
    }
    /// `own`: true for a block of the worker's own share.
    double operator()(int busy, bool own) const {
        const double alone = 1 + (own ? moved_of_own_ : moved_);
        return in_caches_ ? alone : std::max(alone, busy * demand_ / bandwidth_);
    }

private:
    double demand_, bandwidth_, moved_ = 0, moved_of_own_ = 0;
    bool in_caches_ = true;
};

/// Simulated cores that work through the parts of a recording, one part after the other.
class Cores {
public:
    Cores(const Recording& recording, int count, const MachineModel& machine, const Traffic& traffic)
        : recording_(recording),
          machine_(machine),
          slowdown_(count, machine, traffic),
          transfer_(count > machine.cores_per_chiplet ? machine.far_line_transfer : machine.line_transfer),
          workers_(static_cast<std::size_t>(count)),
          costs_(recording.graph.stage_count() + 1) {}

    /// Runs a part, which begins on worker 0 after the end of all earlier parts. Returns the time at which it ends [s].
    double run(std::span<const StageRun> part);
    const std::vector<StageCost>& costs() const { return costs_; }

private:
    /// Blocks of a loop that one worker begins with.
    struct Share {
        Range blocks;        // blocks that no worker has taken yet
        int taker = nobody;  // the worker that took a block last
        double counter_free = 0;
    };
    /// A loop in progress.
    struct Loop {
        int owner;
        int inside;  // number of workers that take its blocks
        std::vector<Share> shares;
    };
    struct Worker {
        Index stage = no_index;  // row of part_ that it runs, if any
        Index piece = 0;         // its next piece
        int loop = nobody;       // owner of the loop from which it takes blocks
        std::size_t share = 0;   // share of that loop from which it takes blocks
        bool idle = true, in_team = false;
        bool handed_out = false;  // it has handed out a loop of its stage
        bool alone = false;       // it runs a serial piece
        double idle_since = 0;
    };
    struct Event {
        double time;
        std::uint64_t number;  // order of creation, which decides between events at the same time
        int worker;
        bool operator>(const Event& other) const {
            return time != other.time ? time > other.time : number > other.number;
        }
    };

    Worker& worker(int w) { return workers_[static_cast<std::size_t>(w)]; }
    void at(double time, int w) { events_.push({time, event_count_++, w}); }
    int busy() const {
        return static_cast<int>(std::ranges::count_if(workers_, [](const Worker& w) { return !w.idle; }));
    }
    /// Returns the time of a block or serial piece with its slowdown [s], and adds it to the costs of the stage.
    double longer(double seconds, bool own, Index stage) {
        const double slower = slowdown_(busy(), own);
        add(stage, &StageCost::work, seconds);
        add(stage, &StageCost::exchange, (slower - 1) * seconds);
        return seconds * slower;
    }
    StageCost& cost_of(Index stage) {
        const Index number = part_[static_cast<std::size_t>(stage)].stage;
        return number == no_index ? costs_.back() : costs_[static_cast<std::size_t>(number)];
    }
    /// Adds the time of one core to a cost of the stage [s].
    void add(Index stage, double StageCost::*what, double seconds) {
        cost_of(stage).*what += seconds / static_cast<double>(workers_.size());
    }
    void pass(double time);
    double seconds_of(Index block) const { return recording_.seconds[static_cast<std::size_t>(block)]; }

    void go_on(int w, double time);
    void start_stage(int w, Index stage);
    void next_piece(int w, double time);
    void take_block(int w, double time);
    void end_stage(int w, double time);
    void find_work(int w, double time);
    void hand_out(int w, const Piece& piece, double time);
    void enter(int w, Loop& loop);
    double run_phase(int w, const Piece& piece, double time);
    void dismiss_team(double time);
    void wake(Index most, double time);
    Loop* open_loop();
    Loop& loop_of(int owner);

    const Recording& recording_;
    const MachineModel& machine_;
    Slowdown slowdown_;
    double transfer_;
    std::vector<Worker> workers_;
    double now_ = 0;

    std::span<const StageRun> part_;
    std::vector<Index> left_;   // number of unfinished predecessors, by stage
    std::vector<Index> ready_;  // stages that may start
    std::vector<Loop> loops_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t event_count_ = 0;
    int team_leader_ = nobody;
    std::vector<StageCost> costs_;  // as returned by stage_costs
    double passed_ = 0;             // time up to which waiting cores have been counted [s]
};

double Cores::run(std::span<const StageRun> part) {
    part_ = part;
    ready_.clear();
    left_.clear();
    if (part.front().stage == no_index) {
        start_stage(0, 0);
    } else {
        left_ = recording_.graph.predecessor_count;
        for (Index s = 0; s < static_cast<Index>(left_.size()); ++s)
            if (left_[static_cast<std::size_t>(s)] == 0) ready_.push_back(s);
        if (ready_.empty()) return now_;
        start_stage(0, ready_.front());
        ready_.erase(ready_.begin());
        wake(static_cast<Index>(ready_.size()), now_);
    }
    at(now_, 0);
    while (!events_.empty()) {
        const Event event = events_.top();
        events_.pop();
        pass(event.time);
        go_on(event.worker, event.time);
    }
    return now_;
}

/// Adds the time of waiting and joining cores up to `time` to the costs.
void Cores::pass(double time) {
    const double seconds = time - passed_;
    passed_ = time;
    if (seconds <= 0) return;
    const auto in_stage = [](const Worker& w) { return w.stage != no_index; };
    const auto waits = [&](const Worker& w) { return w.idle || (in_stage(w) && w.handed_out && w.loop == nobody); };
    const auto joins = [&](const Worker& w) { return !w.idle && !in_stage(w) && w.loop == nobody; };
    const auto waiting = static_cast<double>(std::ranges::count_if(workers_, waits));
    const auto joining = static_cast<double>(std::ranges::count_if(workers_, joins));
    const double share = seconds / static_cast<double>(std::ranges::count_if(workers_, in_stage));
    for (const Worker& w : workers_) {
        if (!in_stage(w)) continue;
        add(w.stage, w.alone ? &StageCost::alone : &StageCost::tail, waiting * share);
        add(w.stage, &StageCost::handing_out, joining * share);
    }
}

void Cores::go_on(int w, double time) {
    if (worker(w).loop != nobody)
        take_block(w, time);
    else if (worker(w).stage != no_index)
        next_piece(w, time);
    else
        find_work(w, time);
}

void Cores::start_stage(int w, Index stage) {
    worker(w).idle = false;
    worker(w).stage = stage;
    worker(w).piece = part_[static_cast<std::size_t>(stage)].pieces.begin;
}

void Cores::next_piece(int w, double time) {
    Worker& self = worker(w);
    self.handed_out = false;
    if (self.piece == part_[static_cast<std::size_t>(self.stage)].pieces.end) {
        end_stage(w, time);
        return;
    }
    const Piece& piece = recording_.pieces[static_cast<std::size_t>(self.piece++)];
    self.alone = piece.kind == PieceKind::serial;
    switch (piece.kind) {
        case PieceKind::serial:
            at(time + longer(seconds_of(piece.blocks.begin), false, self.stage), w);
            return;
        case PieceKind::loop:
            hand_out(w, piece, time);
            return;
        case PieceKind::phase:
            at(run_phase(w, piece, time), w);
            return;
    }
}

void Cores::hand_out(int w, const Piece& piece, double time) {
    const Index count = piece.blocks.size();
    Loop& loop = loops_.emplace_back(Loop{w, 0, {}});
    loop.shares.resize(std::min(workers_.size(), static_cast<std::size_t>(count)));
    const auto begin_of = [&](std::size_t share) {
        return piece.blocks.begin + static_cast<Index>(static_cast<std::size_t>(count) * share / loop.shares.size());
    };
    for (std::size_t s = 0; s < loop.shares.size(); ++s) loop.shares[s].blocks = {begin_of(s), begin_of(s + 1)};
    worker(w).handed_out = true;
    enter(w, loop);
    wake(count - 1, time);
    take_block(w, time);
}

void Cores::enter(int w, Loop& loop) {
    worker(w).loop = loop.owner;
    worker(w).share = static_cast<std::size_t>(w) % loop.shares.size();
    ++loop.inside;
}

Cores::Loop* Cores::open_loop() {
    for (Loop& loop : loops_)
        if (std::ranges::any_of(loop.shares, [](const Share& share) { return share.blocks.size() > 0; })) return &loop;
    return nullptr;
}

Cores::Loop& Cores::loop_of(int owner) {
    return *std::ranges::find_if(loops_, [&](const Loop& loop) { return loop.owner == owner; });
}

/// Takes the next block of the worker's loop, from its own share while that has one. If there is none, the worker
/// leaves the loop. The last worker to leave lets the owner continue.
void Cores::take_block(int w, double time) {
    Loop& loop = loop_of(worker(w).loop);
    const std::size_t count = loop.shares.size(), own = static_cast<std::size_t>(w) % count;
    for (std::size_t tried = 0; tried < count; ++tried) {
        Share& share = loop.shares[worker(w).share];
        if (share.blocks.size() == 0) {
            worker(w).share = (worker(w).share + 1) % count;
            continue;
        }
        double begin = time;
        if (share.taker != nobody && share.taker != w)
            begin = share.counter_free = std::max(time, share.counter_free) + transfer_;
        share.taker = w;
        const Index stage = worker(loop.owner).stage;
        add(stage, &StageCost::handing_out, begin - time);
        at(begin + longer(seconds_of(share.blocks.begin++), worker(w).share == own, stage), w);
        return;
    }
    const int owner = loop.owner;
    worker(w).loop = nobody;
    if (--loop.inside == 0) {
        loops_.erase(loops_.begin() + (&loop - loops_.data()));
        at(time + (w == owner ? 0 : transfer_), owner);
    }
    if (w != owner) find_work(w, time);
}

void Cores::end_stage(int w, double time) {
    const Index stage = worker(w).stage;
    worker(w).stage = no_index;
    now_ = std::max(now_, time);
    if (team_leader_ == w) dismiss_team(time);
    const std::size_t ready_before = ready_.size();
    if (!left_.empty()) {
        const RecordedGraph& graph = recording_.graph;
        const auto row = static_cast<std::size_t>(stage);
        for (Index e = graph.successor_offset[row]; e < graph.successor_offset[row + 1]; ++e) {
            const Index next = graph.successor[static_cast<std::size_t>(e)];
            if (--left_[static_cast<std::size_t>(next)] != 0) continue;
            if (worker(w).stage == no_index)
                start_stage(w, next);
            else
                ready_.push_back(next);
        }
    }
    wake(static_cast<Index>(ready_.size() - ready_before), time);
    go_on(w, time);
}

void Cores::find_work(int w, double time) {
    Worker& self = worker(w);
    self.idle = false;
    if (!ready_.empty()) {
        start_stage(w, ready_.back());
        ready_.pop_back();
        next_piece(w, time);
        return;
    }
    if (Loop* const loop = open_loop()) {
        enter(w, *loop);
        take_block(w, time);
        return;
    }
    self.idle = true;
    self.idle_since = time;
}

/// Wakes up to `most` idle workers, those first that became idle last.
void Cores::wake(Index most, double time) {
    for (; most > 0; --most) {
        int latest = nobody;
        for (int w = 0; w < static_cast<int>(workers_.size()); ++w) {
            const Worker& other = worker(w);
            if (!other.idle || other.in_team) continue;
            if (latest == nobody || other.idle_since > worker(latest).idle_since) latest = w;
        }
        if (latest == nobody) return;
        Worker& woken = worker(latest);
        const bool asleep = time - woken.idle_since > machine_.patience;
        woken.idle = false;
        at(time + (asleep ? machine_.wake_up : machine_.join), latest);
    }
}

/// Runs a phase. Members take blocks in order, each when it has finished its previous one. Returns the end of the phase
/// [s].
double Cores::run_phase(int w, const Piece& piece, double time) {
    const Index count = piece.blocks.size();
    if (team_leader_ == nobody && count > 1) {
        team_leader_ = w;
        int members = 1;
        for (Worker& other : workers_)
            if (other.idle && members < Team::most_members) {
                other.in_team = true;
                ++members;
            }
    }
    const auto members = team_leader_ == w ? 1 + std::ranges::count_if(workers_, &Worker::in_team) : 1;
    const auto at_work = std::min<std::ptrdiff_t>(members, count);
    std::priority_queue<double, std::vector<double>, std::greater<>> free;
    for (std::ptrdiff_t m = 0; m < at_work; ++m) free.push(time);
    double end = time, work = 0;
    const double slower = slowdown_(static_cast<int>(at_work), true);
    for (Index block = piece.blocks.begin; block < piece.blocks.end; ++block) {
        const double done = free.top() + slower * seconds_of(block);
        free.pop();
        free.push(done);
        end = std::max(end, done);
        work += seconds_of(block);
    }
    // All members count their blocks on one cache line.
    const double barrier = at_work == 1 ? 0 : machine_.barrier + static_cast<double>(at_work - 2) * transfer_;
    const Index stage = worker(w).stage;
    add(stage, &StageCost::work, work);
    add(stage, &StageCost::exchange, (slower - 1) * work);
    add(stage, &StageCost::handing_out, barrier * static_cast<double>(at_work));
    // pass() counts members as waiting all the time, since they have no stage. This corrects it.
    add(stage, &StageCost::tail, end - time - slower * work - barrier * static_cast<double>(at_work - 1));
    return end + barrier;
}

void Cores::dismiss_team(double time) {
    team_leader_ = nobody;
    for (Worker& other : workers_)
        if (other.in_team) {
            other.in_team = false;
            other.idle_since = time;
        }
}

}  // namespace

MachineModel MachineModel::free_of_cost() {
    MachineModel machine;
    machine.join = machine.wake_up = machine.barrier = machine.line_transfer = machine.far_line_transfer = 0;
    machine.bandwidth = machine.near_rate = machine.far_rate = std::numeric_limits<double>::infinity();
    return machine;
}

StageCost& StageCost::operator+=(const StageCost& other) {
    work += other.work;
    exchange += other.exchange;
    handing_out += other.handing_out;
    alone += other.alone;
    tail += other.tail;
    return *this;
}

double predict_seconds(const Recording& recording, int cores, const MachineModel& machine, const Traffic& traffic) {
    Cores all(recording, cores, machine, traffic);
    double end = 0;
    for_each_part(recording, [&](std::span<const StageRun> part) { end = all.run(part); });
    return end;
}

std::vector<StageCost> stage_costs(const Recording& recording, int cores, const MachineModel& machine,
                                   const Traffic& traffic) {
    Cores all(recording, cores, machine, traffic);
    for_each_part(recording, [&](std::span<const StageRun> part) { all.run(part); });
    return all.costs();
}

}  // namespace skerry::profiling
