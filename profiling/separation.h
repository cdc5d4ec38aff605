// The parts of profile_separation. Each writes one table (CSV) into a folder; plot_separation.py prints and plots them
// beside the paper's figures (Lazarevych, Szekely, Harders, WSCG 2010, section on results).
#pragma once

#include <filesystem>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

struct SeparationOptions {
    std::filesystem::path out = "out/profiling/separation";
    bool quick = false;
};

/// Whole steps of balls at rest in a bucket (one ball to many) and of a ball that strikes skittles, contacts handled by
/// region and all together: scenes.csv. Returns the contact problems of some steps of both.
std::vector<StepProblem> profile_scenes(const SeparationOptions& options);

/// Many regions of one size side by side: time of separation and solution by region and all together, and separation
/// against one sweep: growth.csv, sweep.csv.
void profile_growth(const SeparationOptions& options);

/// The same with matrices that are not sparse, as the paper has them: one of all contacts of a step against one of each
/// region: dense.csv.
void profile_dense(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// Iterations with the cone and with the pyramid of friction: cone.csv.
void profile_cone(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// The error that each method leaves after a fixed number of iterations: poor.csv.
void profile_poor_cases(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// The paper's Algorithm 1 beside union-find: number of its areas that share a node, and the cost of both. Writes
/// algorithm_1.csv.
void profile_algorithm_1(const SeparationOptions& options, const std::vector<StepProblem>& steps);

}  // namespace skerry::profiling
