#include "engine/program/csv_text.h"

#include <cmath>

#include "engine/scene/place.h"

namespace skerry {

namespace {

std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

}  // namespace

std::string csv_number(double value) {
    if (!std::isfinite(value)) return {};
    constexpr double exact = 1e15;
    return value == std::floor(value) && std::abs(value) < exact ? std::to_string(static_cast<long long>(value))
                                                                 : Json(value).dump();
}

void add_csv_line(const std::vector<std::string>& cells, std::string& csv) {
    for (std::size_t i = 0; i < cells.size(); ++i) csv += (i == 0 ? "" : ",") + csv_cell(cells[i]);
    csv += "\r\n";
}

}  // namespace skerry
