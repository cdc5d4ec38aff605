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

}  // namespace skerry
