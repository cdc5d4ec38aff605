#include "engine/world/complaint.h"

#include <cstdio>
#include <utility>

namespace skerry {

std::string Complaint::text() const {
    std::string message;
    for (const std::string* place : {&file, &object, &field})
        if (!place->empty()) message += *place + ": ";
    if (!found.empty()) message += "found " + found + (expected.empty() ? "" : ", ");
    if (!expected.empty()) message += "expected " + expected;
    if (!hint.empty()) message += " (" + hint + ")";
    return message;
}

void Complaint::raise() const {
    throw SceneError(*this);
}

SceneError::SceneError(const std::string& text, Complaint complaint)
    : std::runtime_error(text), complaint_(std::make_shared<const Complaint>(std::move(complaint))) {}

SceneError error_at(const Complaint& place, const SceneError& inner) {
    Complaint parts = inner.complaint();
    if (parts.file.empty()) {
        parts.file = place.file;
        if (!place.object.empty()) parts.object = place.object;
        parts.field = place.field + (place.field.empty() || parts.field.empty() ? "" : ": ") + parts.field;
    }
    return SceneError(place.text() + inner.what(), parts);
}

std::string short_text(Real value, int digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

void expect_offsets(std::span<const Index> offset, std::size_t items,
                    FunctionRef<void(const std::string& found, const std::string& expected)> complain) {
    const auto most = static_cast<Index>(items);
    for (std::size_t i = 0; i < offset.size(); ++i) {
        const Index least = i == 0 ? 0 : offset[i - 1];
        if (offset[i] >= least && offset[i] <= most && (i > 0 || offset[i] == 0)) continue;
        const std::string found = std::to_string(offset[i]) + " at entry " + std::to_string(i);
        if (i == 0) complain(found, "0, the first offset");
        if (offset[i] > most) complain(found, "an offset <= " + std::to_string(most) + ", the number of items");
        complain(found, "an offset >= " + std::to_string(least) + ", because offsets ascend");
    }
}

}  // namespace skerry
