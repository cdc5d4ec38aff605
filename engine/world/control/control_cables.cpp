// Functions that add, remove and drive cables between steps (docs/methods/cables.md).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/world/control/control.h"
#include "engine/world/query/place_anchor.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"
#include "skerry/cable.h"
#include "systems/forces/prepare_cables.h"

namespace skerry {

namespace {

/// The controlled quantity of a cable. `values` points to its values over time, which a CableDrive owns.
struct CableDriveRow {
    CableControl control;
    const TimeTable* values;
};

std::string title_of_cable(const std::string& first, const std::string& last) {
    return "cable from " + first + " to " + last;
}

std::string title_of_cable(const Model& model, std::size_t row) {
    const AnchorColumns& anchor = model.cables.anchor;
    const auto title_of_point = [&](Index p) {
        return title_of_end(model, anchor.body[static_cast<std::size_t>(p)],
                            anchor.collider[static_cast<std::size_t>(p)]);
    };
    const Range points = model.cables.points[row];
    return title_of_cable(title_of_point(points.begin), title_of_point(points.end - 1));
}

/// Returns the quantity that `drive` gives. Throws SceneError unless `drive` gives exactly one quantity, with valid
/// values. `object`: title of the cable.
CableDriveRow validated(const std::string& object, const CableDrive& drive) {
    const int count = drive.tension.has_value() + drive.length.has_value() + drive.rate.has_value();
    if (count != 1)
        refuse(object, "drive", count == 0 ? "no tension, length or rate" : "more than one of tension, length and rate",
               "exactly one of tension, length and rate");
    const auto require_all = [&](const char* field, const TimeTable& table, auto&& is_good, const char* expected) {
        require_table(object, field, table);
        for (const TimeKey& key : table.keys)
            if (!is_good(key.value)) refuse(object, field, short_text(key.value), expected);
    };
    if (drive.tension) {
        require_all(
            "tension", *drive.tension, [](Real value) { return value >= 0; },
            "a tension >= 0 (N), because a cable does not push");
        return {CableControl::tension, &*drive.tension};
    }
    if (drive.length) {
        require_all(
            "length", *drive.length, [](Real value) { return value > 0; }, "a length > 0 (m)");
        return {CableControl::length, &*drive.length};
    }
    require_all(
        "rate", *drive.rate, [](Real) { return true; }, "");
    return {CableControl::rate, &*drive.rate};
}

void wake_bodies_of_cable(Model& model, std::size_t cable) {
    for (const Index body : rows_of(model.cables.anchor.body, model.cables.points[cable]))
        if (body != no_index) model.wake(static_cast<std::size_t>(body));
}

CableInputs present_cables(const WorldState& state, const AnchorsBetweenSteps& anchors) {
    const Model& model = state.model;
    CableInputs cables =
        CableInputs::bind({}, model.cables, model.bodies, model.nodes, model.colliders, model.any_asleep);
    cables.anchor = anchors.of(model.cables.anchor);
    return cables;
}

/// Present lengths of the segments of a cable [m].
std::vector<Real> lengths_of(const CableInputs& cables, std::size_t cable) {
    std::vector<Real> lengths;
    const Range points = cables.points[cable];
    for (auto p = static_cast<std::size_t>(points.begin); p + 1 < static_cast<std::size_t>(points.end); ++p)
        lengths.push_back((cables.anchor.at(p + 1) - cables.anchor.at(p)).norm());
    return lengths;
}

Real sum_of(std::span<const Real> lengths) {
    Real sum = 0;
    for (const Real length : lengths) sum += length;
    return sum;
}

Real present_length(const WorldState& state, std::size_t cable) {
    const AnchorsBetweenSteps anchors(state);
    return sum_of(lengths_of(present_cables(state, anchors), cable));
}

void append_points(CableTable& table, std::size_t row, std::span<const PlacedAnchor> points) {
    const std::size_t begin = table.anchor.body.size(), end = begin + points.size();
    table.anchor.body.resize(end);
    table.anchor.collider.resize(end);
    table.anchor.point.resize(end);
    table.tension.resize(end);
    table.length.resize(end);
    table.points[row] = {static_cast<Index>(begin), static_cast<Index>(end)};
    for (std::size_t p = 0; p < points.size(); ++p) {
        points[p].store(table.anchor, begin + p);
        table.tension[begin + p] = table.length[begin + p] = 0;
    }
}

std::vector<PlacedAnchor> placed_points(WorldState& state, const std::string& object,
                                        const std::vector<Anchor>& points) {
    if (points.size() < 2) refuse(object, "points", std::to_string(points.size()), "at least 2 points");
    std::vector<PlacedAnchor> placed;
    bool any_body = false;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const std::string field = "points[" + std::to_string(p) + "]";
        placed.push_back(place_anchor(state, points[p], object, field));
        any_body |= points[p].body.has_value();
        if (p > 0 && points[p].point == points[p - 1].point)
            refuse(object, field, "the same place as the point before", "another place");
    }
    if (!any_body) refuse(object, "points", "no point on a body", "at least one point on a body");
    return placed;
}

}  // namespace

CableHandle Cables::add(const CableSettings& cable) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("add_cable");
    Model& model = state.model;
    const std::string object = cable.points.empty() ? "cable"
                                                    : title_of_cable(title_of_end(model, cable.points.front()),
                                                                     title_of_end(model, cable.points.back()));
    const CableDriveRow drive = validated(object, cable.drive);
    if (!(cable.friction >= 0 && std::isfinite(cable.friction)))
        refuse(object, "friction", short_text(cable.friction), "a friction coefficient >= 0");
    const std::vector<PlacedAnchor> points = placed_points(state, object, cable.points);
    CableTable& table = model.cables;
    const std::size_t row = table.size();
    AnyTable(table).resize(row + 1);
    const CableHandle handle = model.cable_map.insert(static_cast<Index>(row));
    table.slot[row] = handle.slot;
    table.control[row] = drive.control;
    table.friction[row] = cable.friction;
    table.released[row] = table.step[row] = table.work[row] = table.dissipated[row] = 0;
    table.points[row] = table.keys[row] = {};
    append_points(table, row, points);
    set_keys(table.keys, table.key, row, drive.values->keys);
    if (drive.control == CableControl::rate) table.released[row] = present_length(state, row);
    wake_bodies_of_cable(model, row);
    model.links_open = true;
    note_forces(model);
    return handle;
}

CableState Cables::state(CableHandle cable) const {
    return cable_state(WorldAccess::state_of(*world_), cable);
}

CableState cable_state(const WorldState& state, CableHandle cable) {
    const auto row = static_cast<std::size_t>(state.model.row(cable, "cable"));
    const CableTable& table = state.model.cables;
    const AnchorsBetweenSteps anchors(state);
    const CableInputs cables = present_cables(state, anchors);
    const Range points = table.points[row];
    CableState now;
    const std::vector<Real> lengths = lengths_of(cables, row);
    for (auto p = static_cast<std::size_t>(points.begin); p < static_cast<std::size_t>(points.end); ++p) {
        now.points.push_back(anchors.at(table.anchor, p));
        if (p + 1 == static_cast<std::size_t>(points.end)) continue;
        now.tension.push_back(table.step[row] > 0 ? table.tension[p] / table.step[row] : 0);
        const Vec3 along = cables.anchor.at(p + 1) - cables.anchor.at(p);
        now.rate += (cables.anchor.velocity(p + 1) - cables.anchor.velocity(p)).dot(along.normalized());
    }
    now.length = sum_of(lengths);
    if (table.control[row] == CableControl::length) now.released = value_at(table.keys_of(row), state.clock.time);
    if (table.control[row] == CableControl::rate) now.released = table.released[row];
    now.work = table.work[row];
    now.dissipated = table.dissipated[row];
    if (table.step[row] > 0) {
        const CableWork last = work_of_cable(now.tension, rows_of(table.length, points), lengths);
        now.work += last.work;
        now.dissipated += last.dissipated;
    }
    return now;
}

CableSettings Cables::settings(CableHandle cable) const {
    const WorldState& state = WorldAccess::state_of(*world_);
    const CableTable& table = state.model.cables;
    const auto row = static_cast<std::size_t>(state.model.row(cable, "settings"));
    const AnchorsBetweenSteps anchors(state);
    CableSettings settings{.points = {}, .drive = {}, .friction = table.friction[row]};
    for (auto p = static_cast<std::size_t>(table.points[row].begin);
         p < static_cast<std::size_t>(table.points[row].end); ++p)
        settings.points.push_back(anchors.at(table.anchor, p));
    const CableControl control = table.control[row];
    auto& driven = control == CableControl::tension  ? settings.drive.tension
                   : control == CableControl::length ? settings.drive.length
                                                     : settings.drive.rate;
    driven = time_table_of(table.keys_of(row));
    return settings;
}

void Cables::set_drive(CableHandle cable, const CableDrive& drive) {
    WorldState& state = WorldAccess::state_of(*world_);
    state.require_between_steps("set_drive");
    Model& model = state.model;
    const auto row = static_cast<std::size_t>(model.row(cable, "set_drive"));
    const CableDriveRow wanted = validated(title_of_cable(model, row), drive);
    CableTable& table = model.cables;
    if (table.control[row] == wanted.control && std::ranges::equal(table.keys_of(row), wanted.values->keys)) return;
    if (wanted.control == CableControl::rate && table.control[row] != CableControl::rate)
        table.released[row] = present_length(state, row);
    table.control[row] = wanted.control;
    set_keys(table.keys, table.key, row, wanted.values->keys);
    wake_bodies_of_cable(model, row);
    note_forces(model);
}

}  // namespace skerry
