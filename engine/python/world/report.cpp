// Reports of steps and runs as Python values.
#include "skerry/report.h"

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

const char* name_of_status(StepStatus status) {
    switch (status) {
        case StepStatus::ok:
            return "ok";
        case StepStatus::not_finite:
            return "not_finite";
        case StepStatus::too_fast:
            return "too_fast";
        case StepStatus::too_far:
            return "too_far";
        case StepStatus::too_stiff:
            return "too_stiff";
        case StepStatus::unsolved:
            return "unsolved";
        case StepStatus::stopped:
            return "stopped";
    }
    return "?";
}

/// An index as a Python number; None for no_index.
nb::object index_or_none(Index index) {
    return index == no_index ? nb::none() : nb::cast(index);
}

nb::dict values_of(const DynamicsChoice& choice) {
    nb::dict values;
    values["body"] = object_of(choice.body);
    values["name"] = choice.name;
    values["dynamics"] = std::string(name_of(choice.dynamics));
    values["estimate"] = python::values_of(choice.estimate);
    values["message"] = choice.message();
    return values;
}

nb::dict values_of(const StartOverlap& overlap) {
    nb::dict values;
    values["first"] = object_of(overlap.first);
    values["second"] = object_of(overlap.second);
    values["collider"] = object_of(overlap.collider);
    values["first_name"] = overlap.first_name;
    values["second_name"] = overlap.second_name;
    values["kind"] = std::string(name_of(overlap.kind));
    values["depth"] = overlap.depth;
    values["direction"] = tuple_of(overlap.direction);
    values["place"] = tuple_of(overlap.place);
    values["resolved"] = overlap.resolved;
    values["message"] = overlap.message();
    return values;
}

nb::dict values_of(const StartMove& move) {
    nb::dict values;
    values["body"] = object_of(move.body);
    values["name"] = move.name;
    values["translation"] = tuple_of(move.translation);
    return values;
}

nb::dict values_of(const SelfCrossing& crossing) {
    nb::dict values;
    values["body"] = object_of(crossing.body);
    values["name"] = crossing.name;
    values["self_contact"] = crossing.self_contact;
    values["first_time"] = crossing.first_time;
    values["last_time"] = crossing.last_time;
    values["last_places"] = crossing.last_places;
    values["most_places"] = crossing.most_places;
    values["message"] = crossing.message();
    return values;
}

nb::dict values_of(const StepLimitReport& limit) {
    nb::dict values;
    values["limit"] = std::string(name_of(limit.limit));
    values["body"] = object_of(limit.body);
    values["body_name"] = limit.body_name;
    values["steps"] = limit.steps;
    values["tries"] = limit.tries;
    values["seconds"] = limit.seconds;
    return values;
}

nb::dict values_of(const StageReport& stage) {
    nb::dict values;
    values["name"] = stage.name;
    values["seconds"] = stage.seconds;
    values["runs"] = stage.runs;
    values["skipped"] = stage.skipped;
    return values;
}

template <class Row>
nb::list list_of(const std::vector<Row>& rows) {
    nb::list values;
    for (const Row& row : rows) values.append(values_of(row));
    return values;
}

nb::object value_of(StepStatus status) {
    return nb::cast(name_of_status(status));
}
nb::object value_of(const BodyHandle& body) {
    return object_of(body);
}
nb::object value_of(Index index) {
    return index_or_none(index);
}
nb::object value_of(Real number) {
    return nb::cast(number);
}
nb::object value_of(const std::string& text) {
    return nb::cast(text);
}

/// Calls visit(name, pointer to member) for each member of StepReport.
void for_each_member(auto&& visit) {
    visit("status", &StepReport::status);
    visit("body", &StepReport::body);
    visit("body_name", &StepReport::body_name);
    visit("node", &StepReport::node);
    visit("element", &StepReport::element);
    visit("value", &StepReport::value);
    visit("step_size", &StepReport::step_size);
    visit("steps", &StepReport::steps);
    visit("shortened", &StepReport::shortened);
    visit("retried", &StepReport::retried);
    visit("limited", &StepReport::limited);
    visit("limited_step", &StepReport::limited_step);
    visit("limited_by", &StepReport::limited_by);
    visit("contacts", &StepReport::contacts);
    visit("regions", &StepReport::regions);
    visit("largest_region", &StepReport::largest_region);
    visit("unconverged", &StepReport::unconverged);
    visit("worst_error", &StepReport::worst_error);
    visit("worst_region", &StepReport::worst_region);
    visit("max_penetration", &StepReport::max_penetration);
    visit("max_gap_violation", &StepReport::max_gap_violation);
    visit("held_penetration", &StepReport::held_penetration);
    visit("inverted", &StepReport::inverted);
    visit("inverted_body", &StepReport::inverted_body);
    visit("inverted_name", &StepReport::inverted_name);
    visit("inverted_element", &StepReport::inverted_element);
    visit("crossed", &StepReport::crossed);
}

static_assert(sizeof(RunCounters) == 32 * sizeof(Real), "every counter must be in add_counters");
void add_counters(const RunCounters& counters, nb::dict& values) {
    values["steps"] = counters.steps;
    values["inline_steps"] = counters.inline_steps;
    values["resting_steps"] = counters.resting_steps;
    values["unstrained"] = counters.unstrained;
    values["shortened"] = counters.shortened;
    values["retried"] = counters.retried;
    values["limited"] = counters.limited;
    values["inversions"] = counters.inversions;
    values["contact_sum"] = counters.contact_sum;
    values["iteration_sum"] = counters.iteration_sum;
    values["solved"] = counters.solved;
    values["unconverged"] = counters.unconverged;
    values["certified"] = counters.certified;
    values["closed_form"] = counters.closed_form;
    values["separating"] = counters.separating;
    values["frictionless"] = counters.frictionless;
    values["in_lanes"] = counters.in_lanes;
    values["contact_steps"] = counters.contact_steps;
    values["swept"] = counters.swept;
    values["large_strain_steps"] = counters.large_strain_steps;
    values["newton_steps"] = counters.newton_steps;
    values["tangent_factors"] = counters.tangent_factors;
    values["max_contacts"] = counters.max_contacts;
    values["max_regions"] = counters.max_regions;
    values["largest_region"] = counters.largest_region;
    values["worst_error"] = counters.worst_error;
    values["worst_region"] = counters.worst_region;
    values["dissipated"] = counters.dissipated;
    values["plastic_work"] = counters.plastic_work;
    values["max_penetration"] = counters.max_penetration;
    values["max_gap_violation"] = counters.max_gap_violation;
    values["start_penetration"] = counters.start_penetration;
    values["start_gap_violation"] = counters.start_gap_violation;
}

/// Adds to `values` the lists of the report, and the numbers of bodies, nodes and other objects in the world.
void add_objects(const WorldReport& report, nb::dict& values) {
    values["asleep"] = report.asleep;
    values["bodies"] = report.bodies;
    values["colliders"] = report.colliders;
    values["nodes"] = report.nodes;
    values["elements"] = report.elements;
    values["clusters"] = report.clusters;
    values["cluster_nodes"] = report.cluster_nodes;
    values["implicit_elements"] = report.implicit_elements;
    values["guards"] = report.guards;
    values["dynamics_choices"] = list_of(report.dynamics_choices);
    values["start_overlaps"] = list_of(report.start_overlaps);
    values["start_moves"] = list_of(report.start_moves);
    values["self_crossings"] = list_of(report.self_crossings);
    values["step_limits"] = list_of(report.step_limits);
    values["stages"] = list_of(report.stages);
}

}  // namespace

nb::dict values_of(const Energy& energy) {
    nb::dict values;
    values["kinetic"] = energy.kinetic;
    values["elastic"] = energy.elastic;
    values["potential"] = energy.potential;
    values["dissipated"] = energy.dissipated;
    return values;
}

nb::dict values_of(const DynamicsEstimate& estimate) {
    nb::dict values;
    values["reason"] = std::string(name_of(estimate.reason));
    values["explicit_step"] = estimate.explicit_step;
    values["implicit_step"] = estimate.implicit_step;
    values["deforming_step"] = estimate.deforming_step;
    values["explicit_cost"] = estimate.explicit_cost;
    values["implicit_cost"] = estimate.implicit_cost;
    values["strain"] = estimate.strain;
    values["damped_above"] = estimate.damped_above;
    return values;
}

nb::dict values_of(const StepReport& report) {
    // Result for a default report. Copying it is faster than making a new dictionary, because most members of a report
    // usually have their default values. It is never freed: static objects are destroyed after the interpreter has
    // ended.
    static const StepReport empty;
    static std::vector<PyObject*> names;  // key of each member, in the order of for_each_member
    static PyObject* const empty_values = [] {
        nb::dict values;
        values["message"] = "";
        values["warning"] = "";
        for_each_member([&](const char* name, auto member) {
            names.push_back(PyUnicode_InternFromString(name));
            values[nb::handle(names.back())] = value_of(empty.*member);
        });
        return values.release().ptr();
    }();
    auto values = nb::steal<nb::dict>(PyDict_Copy(empty_values));
    auto name = names.begin();
    for_each_member([&](const char*, auto member) {
        if (report.*member != empty.*member) values[nb::handle(*name)] = value_of(report.*member);
        ++name;
    });
    if (!report.ok()) values["message"] = report.message();
    if (const std::string warning = report.warning(); !warning.empty()) values["warning"] = warning;
    return values;
}

nb::dict values_of(const WorldReport& report) {
    nb::dict values;
    add_counters(report, values);
    add_objects(report, values);
    values["time"] = report.time;
    values["stable_step"] = report.stable_step;
    values["stable_step_body"] = report.stable_step_body;
    values["mean_contacts"] = report.mean_contacts;
    values["mean_regions"] = report.mean_regions;
    values["mean_iterations"] = report.mean_iterations;
    values["broad_searches"] = report.broad_searches;
    values["pair_searches"] = report.pair_searches;
    values["candidates"] = report.candidates;
    values["crossing_tests"] = report.crossing_tests;
    values["crossings_found"] = report.crossings_found;
    values["crossed"] = report.crossed;
    values["held_penetration"] = report.held_penetration;
    values["held_body"] = report.held_body;
    values["held_in"] = report.held_in;
    values["energy"] = values_of(report.energy);
    values["momentum"] = tuple_of(report.momentum);
    values["angular_momentum"] = tuple_of(report.angular_momentum);
    values["energy_error"] = report.energy_error;
    values["energy_error_share"] = report.energy_error_share;
    values["momentum_error"] = report.momentum_error;
    values["momentum_error_share"] = report.momentum_error_share;
    values["balanced_steps"] = report.balanced_steps;
    values["worst_volume_ratio"] = report.worst_volume_ratio;
    values["worst_volume_body"] = report.worst_volume_body;
    values["worst_volume_element"] = index_or_none(report.worst_volume_element);
    values["near_inversion"] = report.near_inversion;
    values["folded"] = report.folded;
    values["folded_body"] = report.folded_body;
    values["folded_element"] = index_or_none(report.folded_element);
    values["inverted"] = report.inverted;
    values["collider_turn"] = report.collider_turn;
    values["turning_collider"] = report.turning_collider;
    values["distrust"] = report.distrust();
    return values;
}

}  // namespace skerry::python
