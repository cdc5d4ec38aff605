// Errors that tests expect.
#pragma once

#include <string>

#include "skerry/error.h"

namespace skerry::test {

/// Message of the SceneError that `call` throws; empty if it throws none.
std::string message_of(auto&& call) {
    try {
        call();
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

}  // namespace skerry::test
