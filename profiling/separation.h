// The parts of profile_separation. Each writes tables (CSV) into a folder. plot_separation.py prints and plots them
// beside the figures of the paper (Lazarevych, Szekely, Harders, WSCG 2010, section on results).
#pragma once

#include <filesystem>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

struct SeparationOptions {
    std::filesystem::path out = "out/profiling/separation";
    bool quick = false;
};

/// Times whole steps of balls at rest in a bucket (one ball to many) and of a ball that strikes skittles. Contacts are
/// handled by region and all together. Writes scenes.csv. Returns the contact problems of some steps of both scenes.
std::vector<StepProblem> profile_scenes(const SeparationOptions& options);

/// Times many regions of one size side by side: separation and solution by region and all together (growth.csv), and
/// separation against one sweep (sweep.csv).
void profile_growth(const SeparationOptions& options);

/// Times dense matrices, as the paper uses them: one matrix of all contacts of a step against one matrix of each
/// region. Writes dense.csv.
void profile_dense(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// Compares iterations with the cone and with the pyramid of friction. Writes cone.csv.
void profile_cone(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// Measures the error of each method after a fixed number of iterations. Writes poor.csv.
void profile_poor_cases(const SeparationOptions& options, const std::vector<StepProblem>& steps);

/// Compares the paper's Algorithm 1 with union-find: number of pairs of its areas that share a node, and the cost of
/// both. Writes algorithm_1.csv.
void profile_algorithm_1(const SeparationOptions& options, const std::vector<StepProblem>& steps);

}  // namespace skerry::profiling
