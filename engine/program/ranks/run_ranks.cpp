#include "engine/program/ranks/run_ranks.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "components/hash.h"
#include "engine/base/complaint.h"
#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/signal_guard.h"
#include "engine/program/sweep/share.h"
#include "engine/scene/case_hash.h"
#include "jobs/ranks/mpi_ranks.h"
#include "skerry/error.h"
#include "skerry/instruction_set.h"

namespace skerry {

namespace {

/// Error that is thrown on all ranks, so that rank 0 alone reports it.
struct AgreedError : std::runtime_error {
    AgreedError(const std::string& text, int exit_code) : std::runtime_error(text), code(exit_code) {}
    int code;
};

std::string host_name() {
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    return name.data();
}

/// Greatest resident memory of this process so far [bytes].
double peak_memory() {
    constexpr double kib = 1024;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return kib * static_cast<double>(usage.ru_maxrss);
}

std::string rank_name(std::size_t rank, const std::string& host) {
    return "rank " + std::to_string(rank) + " on " + host;
}

int code_of(const std::exception& error) {
    return dynamic_cast<const SceneError*>(&error) != nullptr ? exit_bad_input : exit_failed;
}

std::string file_content(const char* file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string hash_of_text(const std::string& text) {
    Hash hash;
    hash.add(text.data(), text.size());
    return hash_text(hash.value());
}

std::string command_line() {
    std::string text = file_content("/proc/self/cmdline");  // each argument ends with a zero byte
    std::ranges::replace(text, '\0', ' ');
    return text;
}

std::vector<Json> gather_everywhere(Ranks& ranks, const Json& mine) {
    const std::string text = mine.dump();
    std::vector<Json> all;
    for (const RankMessage& message : ranks.gather_everywhere(std::as_bytes(std::span(text)))) {
        const char* const begin = reinterpret_cast<const char*>(message.data());
        all.push_back(Json::parse(begin, begin + message.size()));
    }
    return all;
}

Json work_of(const WorldReport& report) {
    Json stages = Json::object();
    for (const StageReport& stage : report.stages) stages[stage.name] = {stage.seconds, stage.runs, stage.skipped};
    return {{"stages", stages},
            {"broad_searches", report.broad_searches},
            {"pair_searches", report.pair_searches},
            {"candidates", report.candidates},
            {"inline_steps", report.inline_steps}};
}

void add_work(const Json& of_rank, RankWork& sum) {
    for (const auto& [name, stage] : of_rank.at("stages").items()) {
        auto known = std::ranges::find(sum.stages, name, &StageReport::name);
        if (known == sum.stages.end()) known = sum.stages.insert(known, {.name = name});
        known->seconds += stage[0].get<double>();
        known->runs += stage[1].get<std::uint64_t>();
        known->skipped += stage[2].get<std::uint64_t>();
    }
    sum.broad_searches += of_rank.at("broad_searches").get<std::uint64_t>();
    sum.pair_searches += of_rank.at("pair_searches").get<std::uint64_t>();
    sum.candidates += of_rank.at("candidates").get<std::uint64_t>();
    sum.inline_steps += of_rank.at("inline_steps").get<std::uint64_t>();
}

void take_larger(int& into, int from) {
    into = std::max(into, from);
}

}  // namespace

RunRanks RunRanks::join() {
    const Share tasks = task_share(std::getenv);
    if (tasks.of == 1) return {};
    std::unique_ptr<Ranks> ranks = start_mpi(&signal_note);
    if (ranks->size() != tasks.of)
        refuse(tasks.said_by, {},
               std::to_string(tasks.of) + " processes, of which MPI has connected " + std::to_string(ranks->size()),
               "connections between all of them",
               "use the launcher of the MPI library that Skerry was built with; for srun try --mpi=pmix");
    return RunRanks(std::move(ranks));
}

std::vector<Json> RunRanks::agree(const Json& mine) const {
    std::vector<Json> all = gather_everywhere(*ranks_, mine);
    const auto failed = [](const Json& rank) { return rank.contains("error"); };
    const auto first = std::ranges::find_if(all, failed);
    if (first != all.end()) {
        const std::string text = first->at("error");
        const bool is_alike = std::ranges::all_of(
            all, [&](const Json& rank) { return failed(rank) && rank["error"] == first->at("error"); });
        const std::string who = rank_name(static_cast<std::size_t>(first - all.begin()), first->at("host"));
        throw AgreedError(is_alike ? text : who + ": " + text, first->at("code"));
    }
    for (const Json& rank : all)
        if (const int number = rank.value("signal", 0); number != 0)
            throw AgreedError("stopped by a signal before the start", exit_signal + number);
    for (std::size_t r = 1; r < all.size(); ++r)
        for (const auto& [fact, expected] : all[0].at("alike").items())
            if (const Json& found = all[r].at("alike").at(fact); found != expected)
                throw AgreedError(Complaint{.file = {},
                                            .object = rank_name(r, all[r].at("host")),
                                            .field = fact,
                                            .found = found,
                                            .expected = expected.get<std::string>() + " as " +
                                                        rank_name(0, all[0].at("host")) + " has",
                                            .hint = "all ranks need the same program, options, files and instruction "
                                                    "set; SKERRY_INSTRUCTION_SET chooses one that all hosts have"}
                                      .text(),
                                  exit_bad_input);
    return all;
}

Json RunRanks::of_first(const Json& mine) const {
    if (!several()) return mine;
    const std::vector<Json> all = agree({{"host", host_name()},
                                         {"signal", static_cast<int>(caught_signal)},
                                         {"alike", Json::object()},
                                         {"value", mine}});
    return all.front().at("value");
}

void RunRanks::compare_starts(const std::filesystem::path& scene, std::span<const std::string> assignments) {
    if (!several()) return;
    agree({{"host", host_name()},
           {"alike",
            {{"program", SKERRY_VERSION " with the hash " + hash_of_text(file_content("/proc/self/exe"))},
             {"command line", command_line()},
             {"instruction set", instruction_set()},
             {"hash of the scene and its files", CaseHasher(scene).hash(assignments)}}}});
}

RunOptions RunRanks::options_for(const RunOptions& asked) const {
    RunOptions options = asked;
    if (!several()) return options;
    for (const char* option : {"--trace", "--export-problems"})
        if (const auto output = asked.outputs.find(option); output != asked.outputs.end() && !output->second.empty())
            refuse(option, {}, std::to_string(ranks_->size()) + " ranks",
                   "one process, because this output shows the steps of one process only");
    if (!options.overrides.threads) options.overrides.threads = task_share(std::getenv).cores;
    if (!is_first()) options.quiet = true;
    return options;
}

World& RunRanks::divide(Scene& scene, OwnerMap owners) {
    scene_ = &scene;
    if (!several()) return scene.world;
    part_.emplace(std::move(scene.world));
    of_first({});  // throws on all ranks if one has failed; otherwise distribute() would wait for that rank forever
    divided_ = true;
    try {
        distribute(*part_, *ranks_, {.map = owners});
    } catch (const SceneError&) {
        divided_ = false;  // distribute() throws a SceneError on all ranks, so fail() can compare the errors
        throw;
    }
    return *part_;
}

World* RunRanks::gathered_world() {
    if (several() && !is_gathered_) {
        { const World old = std::move(scene_->world); }  // frees the memory of the last gathered world
        std::optional<World> world = gathered(*part_);
        if (world) scene_->world = std::move(*world);
        is_gathered_ = true;
    }
    return is_first() ? &scene_->world : nullptr;
}

void RunRanks::before_advance() {
    is_gathered_ = false;
    if (several()) before_ = ranks_->traffic();
}

void RunRanks::after_advance() {
    if (!several()) return;
    const RankTraffic& now = ranks_->traffic();
    in_steps_.messages += now.messages - before_.messages;
    in_steps_.bytes += now.bytes - before_.bytes;
    in_steps_.reductions += now.reductions - before_.reductions;
    in_steps_.seconds += now.seconds - before_.seconds;
}

bool RunRanks::any(bool mine) const {
    return last_code(mine ? 1 : 0) != 0;
}

void RanksReport::complete(WorldReport& world) const {
    if (count == 1) return;
    world.stages = work.stages;
    world.broad_searches = work.broad_searches;
    world.pair_searches = work.pair_searches;
    world.candidates = work.candidates;
    world.inline_steps = work.inline_steps;
}

RanksReport RunRanks::report(double wall, std::uint64_t steps) const {
    RanksReport report;
    if (!several()) {
        report.peak_memory = {peak_memory()};
        return report;
    }
    const std::vector<Json> all = gather_everywhere(*ranks_, {{"host", host_name()},
                                                              {"peak_memory", peak_memory()},
                                                              {"messages", in_steps_.messages},
                                                              {"bytes", in_steps_.bytes},
                                                              {"wall", wall},
                                                              {"waiting", in_steps_.seconds},
                                                              {"work", work_of(part_->report())}});
    report.count = ranks_->size();
    const auto count = static_cast<double>(std::max<std::uint64_t>(steps, 1));
    report.reductions = static_cast<double>(in_steps_.reductions) / count;
    std::set<std::string> hosts;
    double longest = 0, sum = 0;
    for (const Json& rank : all) {
        hosts.insert(rank["host"]);
        report.peak_memory.push_back(rank["peak_memory"].get<double>());
        report.messages += rank["messages"].get<double>() / count;
        report.bytes += rank["bytes"].get<double>() / count;
        const double waited = rank["waiting"], computed = rank["wall"].get<double>() - waited;
        if (computed + waited > 0) report.waiting += waited / (computed + waited) / report.count;
        longest = std::max(longest, computed);
        sum += computed;
        add_work(rank["work"], report.work);
    }
    report.hosts = static_cast<int>(hosts.size());
    if (sum > 0) report.imbalance = longest * report.count / sum;
    return report;
}

void RunRanks::set_last_words(std::string text) {
    if (!several() || !is_first()) return;
    std::swap(last_words_[0], last_words_[1]);
    last_words_[0] = std::move(text);
    signal_note = last_words_[0].c_str();
}

int RunRanks::fail(const std::exception& error) {
    const auto* agreed = dynamic_cast<const AgreedError*>(&error);
    if (!several() && !is_first_process()) return exit_ok;
    if (!several() || agreed != nullptr) {
        if (is_first()) std::cerr << "skerry: " << error.what() << std::endl;
        return agreed != nullptr ? agreed->code : code_of(error);
    }
    if (divided_) ranks_->abort(error.what(), exit_failed);
    try {
        agree({{"host", host_name()}, {"error", error.what()}, {"code", code_of(error)}});
    } catch (const AgreedError& known) {
        return fail(known);
    }
    return exit_failed;
}

int RunRanks::last_code(int mine) const {
    if (several()) reduce<take_larger>(*ranks_, mine);
    return mine;
}

void require_one_process(const std::string& command) {
    if (command == "run" || command == "sweep") return;
    const Share tasks = task_share(std::getenv);
    if (tasks.of > 1)
        refuse(tasks.said_by, {}, std::to_string(tasks.of) + " processes of `skerry " + command + "`", "one process",
               "only `skerry run` and `skerry sweep` share their work among processes");
}

bool is_first_process() {
    try {
        return task_share(std::getenv).rank == 0;
    } catch (const SceneError&) {
        return true;  // task_share cannot read the variables of the launcher; the caller then reports this error
    }
}

int fail_together(const SceneError& error) {
    RunRanks ranks;
    try {
        ranks = RunRanks::join();
    } catch (const std::exception&) {
        // Processes that MPI does not connect cannot compare their errors. The first one reports its own.
    }
    return ranks.fail(error);
}

}  // namespace skerry
