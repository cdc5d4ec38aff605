#include "profiling/scaling/report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

namespace skerry::profiling {

namespace {

/// Speed-up: time on one core over the time on `cores`; 0 if one of the two is missing.
double speed_up(const std::map<int, double>& seconds, int cores) {
    return seconds.contains(1) && seconds.contains(cores) ? seconds.at(1) / seconds.at(cores) : 0;
}

double per_step(const SceneStudy& study, double seconds) {
    return 1e6 * seconds / static_cast<double>(study.steps);
}

std::string name_of_row(const SceneStudy& study, std::size_t row) {
    return row < study.stage_name.size() ? study.stage_name[row] : "between graphs";
}

void print_stages(const SceneStudy& study) {
    const std::vector<StageSum> sums = sums_by_stage(study.recording);
    const double work = study.recording.work();
    std::printf("    %-34s %10s %7s %10s %10s\n", "stage", "us a step", "%", "serial us", "blocks");
    for (std::size_t s = 0; s < sums.size(); ++s)
        if (sums[s].work > 0.003 * work || sums[s].serial > 0.001 * work)
            std::printf("    %-34s %10.1f %7.2f %10.1f %10.1f\n", name_of_row(study, s).c_str(),
                        per_step(study, sums[s].work), 100 * sums[s].work / work, per_step(study, sums[s].serial),
                        static_cast<double>(sums[s].blocks) / static_cast<double>(study.steps));
}

/// Prints the costs of the stages on `cores` cores, the most expensive first.
void print_costs(const SceneStudy& study, int cores, const std::vector<StageCost>& costs) {
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t s) { return costs[s].sum(); });
    StageCost all;
    for (const StageCost& cost : costs) all += cost;
    const auto row = [&](const char* name, const StageCost& cost) {
        std::printf("    %-34s", name);
        for (const double seconds : {cost.sum(), cost.work, cost.exchange, cost.handing_out, cost.alone, cost.tail})
            std::printf(" %10.1f", per_step(study, seconds));
        std::printf("\n");
    };
    const std::string title = "us a step on " + std::to_string(cores) + " cores";
    std::printf("    %-34s %10s %10s %10s %10s %10s %10s\n", title.c_str(), "all", "work", "exchange", "hand out",
                "one alone", "tail");
    row("all", all);
    for (const std::size_t s : order)
        if (costs[s].sum() > 0.003 * all.sum()) row(name_of_row(study, s).c_str(), costs[s]);
}

nlohmann::json to_json(const SceneStudy& study) {
    nlohmann::json json{{"scene", study.name},
                        {"tetrahedra", study.tetrahedra},
                        {"bodies", study.bodies},
                        {"steps", study.steps},
                        {"contacts", study.contacts},
                        {"regions", study.regions},
                        {"largest_region", study.largest_region},
                        {"us_per_step", per_step(study, study.recording.work())},
                        {"serial_share", study.recording.serial() / study.recording.work()},
                        {"critical_path_share", study.recording.critical_path() / study.recording.work()},
                        {"others_cores", study.others},
                        {"bytes_per_second_of_a_core", study.traffic.bytes_per_second}};
    for (const auto& [cores, seconds] : study.predicted) json["predicted_s"][std::to_string(cores)] = seconds;
    for (const auto& [threads, seconds] : study.measured) json["measured_s"][std::to_string(threads)] = seconds;
    return json;
}

nlohmann::json to_json(const MachineModel& machine) {
    return {{"join_s", machine.join},
            {"wake_up_s", machine.wake_up},
            {"patience_s", machine.patience},
            {"barrier_s", machine.barrier},
            {"line_transfer_s", machine.line_transfer},
            {"far_line_transfer_s", machine.far_line_transfer},
            {"cores_per_chiplet", machine.cores_per_chiplet},
            {"cache_per_chiplet_bytes", machine.cache_per_chiplet},
            {"bandwidth_bytes_per_s", machine.bandwidth},
            {"near_rate_bytes_per_s", machine.near_rate},
            {"far_rate_bytes_per_s", machine.far_rate},
            {"own_from_elsewhere", machine.own_from_elsewhere}};
}

nlohmann::json to_json(const MemoryFigures& memory) {
    return {{"bytes_per_tetrahedron_in_balls", memory.tetrahedron_in_balls},
            {"bytes_per_tetrahedron_in_body", memory.tetrahedron_in_body},
            {"bytes_fixed", memory.fixed},
            {"bytes_per_contact", memory.contact},
            {"bytes_per_contact_in_tables", memory.contact_tables},
            {"contacts", memory.contacts},
            {"balls", memory.balls}};
}

void write_scaling(const std::filesystem::path& file, std::span<const SceneStudy> studies) {
    std::ofstream out(file);
    out << "scene,tetrahedra,contacts,us_per_step,serial_share,critical_path_share,cores,predicted,"
           "measured,others\n";
    for (const SceneStudy& study : studies)
        for (const auto& [cores, seconds] : study.predicted)
            out << study.name << ',' << study.tetrahedra << ',' << study.contacts << ','
                << per_step(study, study.recording.work()) << ',' << study.recording.serial() / study.recording.work()
                << ',' << study.recording.critical_path() / study.recording.work() << ',' << cores << ','
                << speed_up(study.predicted, cores) << ',' << speed_up(study.measured, cores) << ','
                << (study.measured.contains(cores) ? study.others : 0) << '\n';
}

void write_stages(const std::filesystem::path& file, std::span<const SceneStudy> studies) {
    std::ofstream out(file);
    out << "scene,stage,us_per_step,serial_us_per_step,blocks_per_step\n";
    for (const SceneStudy& study : studies) {
        const std::vector<StageSum> sums = sums_by_stage(study.recording);
        for (std::size_t s = 0; s < sums.size(); ++s)
            out << study.name << ',' << name_of_row(study, s) << ',' << per_step(study, sums[s].work) << ','
                << per_step(study, sums[s].serial) << ','
                << static_cast<double>(sums[s].blocks) / static_cast<double>(study.steps) << '\n';
    }
}

}  // namespace

void print(const SceneStudy& study) {
    const double work = study.recording.work();
    std::printf("\n%s: %zu tetrahedra, %zu bodies, %llu steps recorded, %.0f contacts, %.0f regions, largest %d\n",
                study.name.c_str(), study.tetrahedra, study.bodies, static_cast<unsigned long long>(study.steps),
                study.contacts, study.regions, study.largest_region);
    std::printf("  recorded: %.1f us a step, serial %.2f %%, longest chain %.2f %% (no more than %.1f x)\n",
                per_step(study, work), 100 * study.recording.serial() / work,
                100 * study.recording.critical_path() / work, work / study.recording.critical_path());
    std::printf("  predicted:");
    for (const auto& [cores, seconds] : study.predicted)
        std::printf("  %d: %.2f x", cores, speed_up(study.predicted, cores));
    std::printf("\n  measured: ");
    for (const auto& [threads, seconds] : study.measured)
        std::printf("  %d: %.2f x, %.1f us a step", threads, speed_up(study.measured, threads),
                    per_step(study, seconds));
    std::printf("; other programs took %.2f cores meanwhile\n", study.others);
    print_stages(study);
    for (const auto& [cores, costs] : study.costs) print_costs(study, cores, costs);
    std::fflush(stdout);
}

void print(const MemoryFigures& memory) {
    std::printf(
        "\nmemory: %.0f bytes a tetrahedron in small balls, %.0f in one large body, %.1f MB besides\n"
        "  a contact %.0f bytes in tables, %.1f kB with all that finds and solves it (%zu contacts of %zu balls)\n",
        memory.tetrahedron_in_balls, memory.tetrahedron_in_body, 1e-6 * memory.fixed, memory.contact_tables,
        1e-3 * memory.contact, memory.contacts, memory.balls);
}

void print(const HandingOutCosts& costs, const MachineModel& machine) {
    std::printf("handing out work here, on two threads: join %.2f us, wake-up %.1f us, barrier %.2f us\n",
                1e6 * costs.join, 1e6 * costs.wake_up, 1e6 * costs.barrier);
    std::printf("in the model:                          join %.2f us, wake-up %.1f us, barrier %.2f us\n",
                1e6 * machine.join, 1e6 * machine.wake_up, 1e6 * machine.barrier);
}

void write(const std::filesystem::path& folder, const ScalingReport& report, const StudyOptions& options) {
    std::filesystem::create_directories(folder);
    if (!report.studies.empty()) {
        write_scaling(folder / "scaling.csv", report.studies);
        write_stages(folder / "stages.csv", report.studies);
    }
    nlohmann::json json{
        {"machine", to_json(options.machine)},
        {"measured_here",
         {{"join_s", report.costs.join}, {"wake_up_s", report.costs.wake_up}, {"barrier_s", report.costs.barrier}}},
        {"bytes_per_tetrahedron_and_step", options.bytes_per_tetrahedron},
        {"claimed_workers", options.claimed_workers},
        {"scenes", nlohmann::json::array()}};
    for (const SceneStudy& study : report.studies) json["scenes"].push_back(to_json(study));
    if (report.memory) json["memory"] = to_json(*report.memory);
    std::ofstream(folder / "scaling.json") << json.dump(1) << '\n';
}

}  // namespace skerry::profiling
