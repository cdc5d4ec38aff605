#include "engine/live/messages.h"

#include <algorithm>
#include <cmath>

#include "engine/output/page/stream/pack.h"

namespace skerry {

namespace {

Json json_of_state(const LiveState& state) {
    return object_of({{"playing", state.playing}, {"rate", state.rate}, {"gravity", state.gravity}});
}

Json json_of_sliders(const LiveRunInfo& info) {
    Json list = Json::array();
    for (std::size_t s = 0; s < info.sliders.size(); ++s) {
        const Slider& slider = info.sliders[s];
        list.push_back(object_of({{"name", slider.name},
                                  {"unit", slider.unit},
                                  {"low", slider.low},
                                  {"high", slider.high},
                                  {"value", info.slider_values[s]}}));
    }
    return list;
}

Json json_of_plots(const std::vector<LivePlot>& plots) {
    Json list = Json::array();
    for (const LivePlot& plot : plots) {
        Json columns = Json::array();
        for (const SeriesColumn& column : plot.columns)
            columns.push_back(object_of({{"name", column.quantity}, {"unit", column.unit}}));
        list.push_back(object_of({{"name", plot.name}, {"columns", columns}}));
    }
    return list;
}

}  // namespace

std::string begin_text(const LiveRunInfo& info, const LiveState& state) {
    Json run = object_of({{"title", info.title}, {"gravity", {info.gravity.x(), info.gravity.y(), info.gravity.z()}}});
    run.update(json_of_objects(PageStream{}, {}));
    return text_of(object_of({{"type", "begin"},
                              {"run", run},
                              {"state", json_of_state(state)},
                              {"sliders", json_of_sliders(info)},
                              {"plots", json_of_plots(info.plots)}}));
}

std::string state_text(const LiveState& state) {
    Json json = object_of({{"type", "state"}});
    json.update(json_of_state(state));
    return text_of(json);
}

std::string problem_text(const std::string& problem) {
    return text_of(object_of({{"type", "problem"}, {"text", problem}}));
}

LiveEncoder::Messages LiveEncoder::pack(const Snapshot& snapshot, std::uint64_t frame, std::uint64_t client) {
    Messages messages;
    messages.changes = stream_.pack(snapshot.frame);
    if (const PageCounts now = counts_of(stream_); now != known_) {
        Json added = object_of({{"type", "add"}});
        added.update(json_of_objects(stream_, known_));
        added["visual_stream"] =
            now.visuals > known_.visuals ? base64(stream_.visuals().packed(known_.visuals)) : std::string();
        messages.added = text_of(added);
        known_ = now;
    }
    messages.row = row_text(snapshot, frame, client);
    return messages;
}

bool LiveEncoder::is_outgrown(const Snapshot& snapshot) const {
    constexpr std::size_t least = 1000;
    const std::size_t stored = stream_.bodies().size() + stream_.colliders().size() + stream_.lines().size();
    const Frame& frame = snapshot.frame;
    const std::size_t present = frame.bodies.size() + frame.colliders.size() + frame.lines.size();
    return stored > present + std::max(present, least);
}

/// Returns the upper end of a legend for `values_`: the 99th percentile of the positive finite values, so that few
/// extreme values do not stretch the legend; 0 if there are none. For up to 100 values it is the largest. Reorders
/// `values_`, and removes values that are not positive or not finite.
Real LiveEncoder::legend_top() {
    std::erase_if(values_, [](Real value) { return !(value > 0) || !std::isfinite(value); });
    if (values_.empty()) return 0;
    const Real rank = std::ceil(0.99 * static_cast<Real>(values_.size() - 1));
    const auto position = values_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::ranges::nth_element(values_, position);
    return *position;
}

Real LiveEncoder::legend_top(std::size_t field) {
    values_.clear();
    for (const PageStream::BodyValues& body : stream_.values())
        values_.insert(values_.end(), body.field[field].begin(), body.field[field].end());
    return legend_top();
}

std::string LiveEncoder::row_text(const Snapshot& snapshot, std::uint64_t frame, std::uint64_t client) {
    Json top = object_of({{"speed", legend_top(0)},
                          {"stress", legend_top(stress_field)},
                          {"strain", legend_top(strain_field)},
                          {"error", legend_top(error_field)}});
    values_.clear();
    for (const Contact& contact : snapshot.frame.contacts) values_.push_back(contact.force().norm());
    top["force"] = legend_top();
    values_.clear();
    for (const LineFrame& line : snapshot.frame.lines)
        for (const Real force : line.force) values_.push_back(std::abs(force));
    top["line_force"] = legend_top();
    Json pull;
    const auto own = std::ranges::find(snapshot.pulls, client, &std::pair<std::uint64_t, PullState>::first);
    if (own != snapshot.pulls.end()) pull = object_of({{"force", own->second.force}, {"length", own->second.length}});
    Json row = object_of({{"type", "row"}, {"number", frame}});
    row.update(json_of_row(row_of(snapshot.frame)));
    row.update(object_of({{"top", top},
                          {"probes", snapshot.probes},
                          {"sliders", snapshot.sliders},
                          {"pull", pull},
                          {"speed", snapshot.speed}}));
    return text_of(row);
}

}  // namespace skerry
