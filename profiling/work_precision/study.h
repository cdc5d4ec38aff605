// Shared declarations of the parts of profile_work_precision: options, peers, tables.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "profiling/work_precision/runs.h"

namespace skerry::profiling {

struct StudyOptions {
    std::vector<std::string> scenes;  // empty: all
    std::filesystem::path out = "out/profiling/work_precision";
    std::string python = "python3";  // Python that may have MuJoCo
    bool quick = false;
    bool no_peers = false;
    double cap = 6;  // CPU time of the longest run that is compared [s]
    int repeat = 3;  // repeats of short runs; medians count

    bool wants(const std::string& scene) const;
};

/// One row of work_precision.csv.
struct Row {
    std::string axis, engine, variant;
    Real tolerance = 0;        // of the contact solver; 0: none
    Real error = 0;            // against the reference of Skerry
    Real error_own = 0;        // against the engine's own reference
    Real reference_error = 0;  // distance of Skerry's reference from the next coarser run
    Real own_reference_error = 0;
};

struct Study {
    StudyOptions options;
    std::vector<Peer> peers;
    std::ofstream table;

    void write(const PrecisionScene& scene, const Row& row, const Record& record);
    /// Shows progress in a line on stderr that is overwritten.
    void show(const std::string& name) const;
    /// Runs Skerry. Runs that take less than 0.5 s are repeated.
    Record run(const PrecisionScene& scene, const SkerryVariant& variant, Real step) const;
    /// Runs the peer with steps that are halved from run to run. The last run is the engine's own reference and may
    /// take four times the cap. Earlier runs may take half of that at most.
    std::vector<Record> run_ladder(const PrecisionScene& scene, const Peer& peer) const;
};

/// (a) time step and integrator, with the peers.
void study_time(Study& study);
/// (b) solver and tolerance.
void study_solver(Study& study);
/// (c) mesh refinement, linear and smoothed elements, with the peers.
void study_mesh(Study& study);
/// Statistics of a pile. Writes pile.csv.
void study_pile(Study& study);
/// Creep of a block that friction holds. Writes creep.csv.
void study_creep(Study& study);

}  // namespace skerry::profiling
