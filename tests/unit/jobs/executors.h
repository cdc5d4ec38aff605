// Every backend of the build with several worker counts, for tests that must hold on all of them.
#pragma once

#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "jobs/executor.h"

namespace skerry {

struct ExecutorChoice {
    Backend backend;
    int workers;

    std::unique_ptr<Executor> make() const { return make_executor(backend, workers); }
    std::string text() const { return std::string(name_of(backend)) + ", " + std::to_string(workers) + " workers"; }
};

/// All backends with these worker counts. More workers than cores are intended: they cause other interleavings.
inline std::vector<ExecutorChoice> executor_choices(const std::vector<int>& workers = {1, 2, 4, 8}) {
    std::vector<ExecutorChoice> choices;
    for (Backend backend : available_backends()) {
        if (backend == Backend::serial) {
            choices.push_back({backend, 1});
        } else {
            for (int count : workers) choices.push_back({backend, count});
        }
    }
    return choices;
}

}  // namespace skerry
