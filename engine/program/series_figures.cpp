#include "engine/program/series_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skerry {

namespace {

/// Ending of the name of a figure with this unit, for example _m_s for m/s.
std::string ending(std::string unit) {
    if (unit == "1") return {};
    std::ranges::replace_if(
        unit, [](char c) { return c == ' ' || c == '/'; }, '_');
    return "_" + unit;
}

}  // namespace

SeriesFigures::SeriesFigures(World& world, const std::vector<RecordedProbe>& probes) : recorder_(world, probes) {
    recorder_.sample(world);
}

void SeriesFigures::sample(const World& world) {
    recorder_.sample(world);
}

std::vector<std::pair<std::string, double>> SeriesFigures::all() const {
    std::vector<std::pair<std::string, double>> figures;
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t c = 1; c < recorder_.columns().size(); ++c) {  // column 0 is the time
        double least = none, most = none, end = none, sum = 0, seconds = 0;
        std::size_t count = 0;
        for (std::size_t row = 0; row < recorder_.row_count(); ++row) {
            const double value = recorder_.row(row)[c];
            if (!std::isfinite(value)) continue;
            least = count > 0 ? std::min(least, value) : value;
            most = count > 0 ? std::max(most, value) : value;
            end = value;
            const double since = row > 0 ? recorder_.row(row)[0] - recorder_.row(row - 1)[0] : 0;
            sum += since * value;
            seconds += since;
            ++count;
        }
        const SeriesColumn& column = recorder_.columns()[c];
        const auto add = [&](const char* which, double value) {
            figures.emplace_back(column.probe + "." + column.quantity + which + ending(column.unit), value);
        };
        add("_end", end);
        add("_min", least);
        add("_max", most);
        add("_mean", seconds > 0 ? sum / seconds : end);
    }
    return figures;
}

}  // namespace skerry
