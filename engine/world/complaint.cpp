#include <utility>

#include "skerry/error.h"

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

}  // namespace skerry
