#include <cmath>
#include <ostream>

#include "engine/base/write_file.h"
#include "engine/output/number_text.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/run_result.h"
#include "engine/program/start_text.h"
#include "skerry/instruction_set.h"

namespace skerry {

namespace {

Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

Json errors_of(const RunResult& result) {
    Json errors = Json::array();
    for (const ErrorEstimate& estimate : result.errors)
        errors.push_back(object_of({{"body", estimate.name},
                                    {"mesh", number_or_null(estimate.mesh)},
                                    {"deflection", number_or_null(estimate.deflection)},
                                    {"interpolation", number_or_null(estimate.interpolation)},
                                    {"stress", number_or_null(estimate.stress)},
                                    {"step", number_or_null(estimate.step)},
                                    {"contact", number_or_null(estimate.contact)},
                                    {"deformation", number_or_null(estimate.deformation)},
                                    {"overlap", number_or_null(estimate.overlap)},
                                    {"gap", number_or_null(estimate.gap)},
                                    {"contact_radius", number_or_null(estimate.contact_radius)},
                                    {"contact_edge", number_or_null(estimate.contact_edge)},
                                    {"worst_tetrahedron", estimate.worst_tetrahedron},
                                    {"time", number_or_null(estimate.time)}}));
    return errors;
}

/// Returns the error estimates of the run. The key `warnings` of the document describes those that are too large.
Json trust_of(const RunResult& result) {
    const WorldReport& r = result.report;
    return object_of({
        {"solver", object_of({{"worst_error", r.worst_error},
                              {"tolerance", result.settings.tolerance},
                              {"unconverged", r.unconverged}})},
        {"energy",
         object_of({{"error", r.energy_error}, {"share", r.energy_error_share}, {"steps", r.balanced_steps}})},
        {"momentum",
         object_of({{"error", number_or_null(r.momentum_error)}, {"share", number_or_null(r.momentum_error_share)}})},
        {"penetration", object_of({{"largest", r.max_penetration},
                                   {"of_mean_edge", result.mean_edge > 0 ? r.max_penetration / result.mean_edge : 0},
                                   {"held", r.held_penetration},
                                   {"held_body", r.held_body},
                                   {"held_in", r.held_in}})},
        {"distrust", r.distrust()},
        {"elements", object_of({{"smallest_volume_ratio", r.worst_volume_ratio},
                                {"body", r.worst_volume_body},
                                {"element", r.worst_volume_element},
                                {"near_inversion", r.near_inversion},
                                {"folded", r.folded},
                                {"inverted", r.inverted},
                                {"inversions", r.inversions}})},
        {"warnings", warnings_of(result)},
    });
}

class StatisticsFile final : public Writer {
public:
    StatisticsFile(const std::filesystem::path& file, const RunResult& result) : file_(file), result_(result) {}

    void close(const World&) override {
        write_file(file_, [&](std::ostream& out) { out << statistics_of(result_).dump(1) << "\n"; });
    }
    std::string written() const override { return file_.string() + " (all statistics of the run)"; }

private:
    std::filesystem::path file_;
    const RunResult& result_;
};

}  // namespace

std::unique_ptr<Writer> statistics_file(const std::filesystem::path& file, const RunResult& result) {
    return std::make_unique<StatisticsFile>(file, result);
}

Json statistics_of(const RunResult& result) {
    const WorldReport& r = result.report;
    Json stages = Json::object(), probes = Json::object(), limits = Json::array(), failed = Json::object();
    Json moves = Json::array(), self_crossings = Json::array(), ties = Json::object();
    for (const auto& [option, failure] : result.outputs_failed) failed[option] = failure;
    for (const StartMove& move : r.start_moves)
        moves.push_back(object_of({{"body", move.name}, {"translation", vector_json(move.translation)}}));
    for (const SelfCrossing& crossing : r.self_crossings)
        self_crossings.push_back(object_of({{"body", crossing.name},
                                            {"self_contact", crossing.self_contact},
                                            {"first_time", crossing.first_time},
                                            {"last_time", crossing.last_time},
                                            {"last_places", crossing.last_places},
                                            {"most_places", crossing.most_places}}));
    for (const StepLimitReport& limit : r.step_limits)
        limits.push_back(object_of({{"limit", name_of(limit.limit)},
                                    {"body", limit.body_name},
                                    {"steps", limit.steps},
                                    {"given_up", limit.tries},
                                    {"seconds", limit.seconds}}));
    for (const StageReport& stage : r.stages)
        stages[stage.name] = object_of({{"seconds", stage.seconds}, {"runs", stage.runs}, {"skipped", stage.skipped}});
    for (const BrokenTie& tie : result.broken_ties)
        ties[tie.name] = object_of({{"nodes", tie.nodes},
                                    {"broken", tie.broken},
                                    {"first_time", tie.first_time},
                                    {"last_time", tie.last_time},
                                    {"largest_force", tie.largest_force}});
    for (const ProbeRecord& probe : result.probes) probes[probe.name] = to_json(probe);
    const double simulated = result.seconds_simulated, wall = result.seconds_wall;
    return object_of({
        {"schema", "skerry.run/2"},
        {"scene", result.scene},
        {"scene_file", result.scene_file},
        {"status", result.status},
        {"seconds_simulated", simulated},
        {"steps", r.steps},
        {"shortened_steps", r.shortened},
        {"retried_steps", r.retried},
        {"limited_steps", r.limited},
        {"step_limits", limits},
        {"seconds_wall", wall},
        {"seconds_load", result.seconds_load},
        {"seconds_setup", result.seconds_setup},
        {"seconds_output", result.seconds_output},
        {"real_time_factor", wall > 0 ? simulated / wall : 0},
        {"frames", result.frames},
        {"outputs_failed", failed},
        {"restarted_at", result.restarted_at ? Json(*result.restarted_at) : Json()},
        {"checkpoints", object_of({{"written", result.checkpoints}, {"failed", result.checkpoints_failed}})},
        {"threads", result.threads},
        {"ranks", object_of({{"count", result.ranks.count},
                             {"hosts", result.ranks.hosts},
                             {"peak_memory", result.ranks.peak_memory},
                             {"messages_per_step", result.ranks.messages},
                             {"bytes_per_step", result.ranks.bytes},
                             {"reductions_per_step", result.ranks.reductions},
                             {"waiting", result.ranks.waiting},
                             {"imbalance", result.ranks.imbalance}})},
        {"backend", name_of(result.settings.backend)},
        {"instruction_set", instruction_set()},
        {"start", object_of({{"overlaps", overlaps_json(r)},
                             {"moves", moves},
                             {"penetration", r.start_penetration},
                             {"gap_violation", r.start_gap_violation}})},
        {"bodies", r.bodies},
        {"asleep", r.asleep},
        {"colliders", r.colliders},
        {"nodes", r.nodes},
        {"elements", r.elements},
        {"integrator", name_of(result.settings.integrator)},
        {"dynamics_choices", choices_json(r)},
        {"large_strain", object_of({{"body_steps", r.large_strain_steps},
                                    {"newton_steps", r.newton_steps},
                                    {"tangent_factors", r.tangent_factors}})},
        {"clusters", object_of({{"on", result.settings.clusters},
                                {"count", r.clusters},
                                {"nodes", r.cluster_nodes},
                                {"implicit_elements", r.implicit_elements},
                                {"guards", r.guards}})},
        {"stable_dt", r.stable_step},
        {"stable_dt_body", r.stable_step_body},
        {"contacts", object_of({{"mean", r.mean_contacts}, {"max", r.max_contacts}})},
        {"regions",
         object_of({{"mean", r.mean_regions}, {"max", r.max_regions}, {"largest_contacts", r.largest_region}})},
        {"stages", stages},
        {"solver", object_of({{"method", name_of(result.settings.method)},
                              {"friction", name_of(result.settings.friction)},
                              {"contact_regions", name_of(result.settings.contact_regions)},
                              {"tolerance", result.settings.tolerance},
                              {"iterations_mean", r.mean_iterations},
                              {"worst_error", r.worst_error},
                              {"worst_error_contacts", r.worst_region},
                              {"unconverged", r.unconverged},
                              {"solved", r.solved},
                              {"closed_form", r.closed_form},
                              {"certified", r.certified},
                              {"separating", r.separating},
                              {"frictionless", r.frictionless},
                              {"in_lanes", r.in_lanes},
                              {"contact_steps", r.contact_steps},
                              {"swept", r.swept}})},
        {"search", object_of({{"broad_searches", r.broad_searches},
                              {"pair_searches", r.pair_searches},
                              {"candidates", r.candidates},
                              {"inline_steps", r.inline_steps},
                              {"resting_steps", r.resting_steps},
                              {"unstrained", r.unstrained},
                              {"crossing_tests", r.crossing_tests},
                              {"crossings_found", r.crossings_found},
                              {"crossed", r.crossed}})},
        {"energy", object_of({{"kinetic", r.energy.kinetic},
                              {"elastic", r.energy.elastic},
                              {"potential", r.energy.potential},
                              {"dissipated", r.energy.dissipated},
                              {"plastic_work", r.plastic_work}})},
        {"momentum", vector_json(r.momentum)},
        {"angular_momentum", vector_json(r.angular_momentum)},
        {"self_crossings", self_crossings},
        {"max_penetration", r.max_penetration},
        {"max_gap_violation", r.max_gap_violation},
        {"mean_edge", result.mean_edge},
        {"errors", errors_of(result)},
        {"trust", trust_of(result)},
        {"notes", result.notes},
        {"broken_ties", ties},
        {"probes", probes},
        {"state_hash", hash_text(result.state_hash)},
    });
}

}  // namespace skerry
