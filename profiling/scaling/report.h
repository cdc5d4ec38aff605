// Results of all scenes: as text, as tables for the plot, and as JSON.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "profiling/scaling/measure_costs.h"
#include "profiling/scaling/memory.h"
#include "profiling/scaling/study.h"

namespace skerry::profiling {

struct ScalingReport {
    std::vector<SceneStudy> studies;
    std::optional<MemoryFigures> memory;
    HandingOutCosts costs;  // measured on this machine, for comparison with the model
};

void print(const SceneStudy& study);
void print(const MemoryFigures& memory);
void print(const HandingOutCosts& costs, const MachineModel& machine);

/// Writes scaling.csv, stages.csv and scaling.json. The JSON file also holds the machine model.
void write(const std::filesystem::path& folder, const ScalingReport& report, const StudyOptions& options);

}  // namespace skerry::profiling
