// A random graph of stages; every edge leads to a later stage.
#pragma once

#include <random>
#include <vector>

#include "jobs/executor.h"

namespace skerry {

struct RandomGraph {
    std::vector<Index> successor_offset{0}, successor, predecessor_count;

    RandomGraph(unsigned seed, int stages, double edge_share) : predecessor_count(static_cast<std::size_t>(stages), 0) {
        std::mt19937 random(seed);
        for (int from = 0; from < stages; ++from) {
            for (int to = from + 1; to < stages; ++to) {
                if (static_cast<double>(random()) >= edge_share * static_cast<double>(std::mt19937::max())) continue;
                successor.push_back(to);
                ++predecessor_count[static_cast<std::size_t>(to)];
            }
            successor_offset.push_back(static_cast<Index>(successor.size()));
        }
    }

    GraphEdges edges() const { return {successor_offset, successor, predecessor_count}; }
    Index stage_count() const { return static_cast<Index>(predecessor_count.size()); }
};

}  // namespace skerry
