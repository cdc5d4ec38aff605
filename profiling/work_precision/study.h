// What the parts of profile_work_precision share: options, peers, tables.
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
    std::string python = "python3";  // that may have MuJoCo
    bool quick = false;
    bool no_peers = false;
    double cap = 6;  // CPU seconds of the longest run that is compared
    int repeat = 3;  // of short runs; medians count

    bool wants(const std::string& scene) const;
};

/// One row of work_precision.csv.
struct Row {
    std::string axis, engine, variant;
    Real tolerance = 0;        // of the contact solver; 0: none
    Real error = 0;            // against our reference
    Real error_own = 0;        // against the engine's own reference
    Real reference_error = 0;  // how far our reference is from the next coarser one
    Real own_reference_error = 0;
};

struct Study {
    StudyOptions options;
    std::vector<Peer> peers;
    std::ofstream table;

    void write(const PrecisionScene& scene, const Row& row, const Record& record);
    /// A line on stderr that moves on.
    void show(const std::string& what) const;
    /// Runs that are over soon are repeated.
    Record run(const PrecisionScene& scene, const SkerryVariant& variant, Real step) const;
    /// The last run is the engine's own reference and may take four times the cap; runs before it are given half of
    /// that at most.
    std::vector<Record> run_ladder(const PrecisionScene& scene, const Peer& peer) const;
};

/// (a) time step and integrator, with the peers.
void study_time(Study& study);
/// (b) solver and tolerance.
void study_solver(Study& study);
/// (c) mesh refinement, linear and smoothed elements, with the peers.
void study_mesh(Study& study);
/// A pile by its statistics: pile.csv.
void study_pile(Study& study);
/// Friction that holds: creep.csv.
void study_creep(Study& study);

}  // namespace skerry::profiling
