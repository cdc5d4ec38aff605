// Solves all regions of the step, concurrently (design.md section 2; methods.md 2 and 3.3).
#pragma once

#include <memory>
#include <span>

#include "components/contact_table.h"
#include "components/options.h"
#include "components/region_table.h"
#include "jobs/executor.h"

namespace skerry {

struct SolverSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    WarmStart warm_start = WarmStart::on;
    Real tolerance = 1e-3;                  // e_nat, methods.md 2.1
    Index max_iterations = 200;             // sweeps of a region
    bool fixed_iterations = false;          // do exactly max_iterations sweeps: with pgs, separate and global are then bitwise the same
    Real relaxation = 1.0;                  // over-relaxation of the sweep
    Real restitution_speed = 0.05;          // m/s: slower impacts do not bounce (methods.md 1.3 b)
    Real recovery = 0.15;                   // beta: share of a negative gap taken back per step by the split impulse (methods.md 1.3 c)
    Real recovery_speed = 0.5;              // m/s, cap of the recovery
    Index parallel_region_contacts = 2000;  // larger regions: coloured order, all workers within the region
    // Shortcuts (methods.md 7): off changes no result beyond the tolerance.
    bool certify_warm_start = true;      // no sweep where the warm start solves the region
    bool skip_separating = true;         // no impulse where no contact closes
    bool frictionless_rows = true;       // scalar rows where no contact of the region has friction
    bool freeze_contacts = false;        // no work on contacts at rest within a solve: up to 25 % slower on sheets of 18 to 1922 contacts
    bool small_regions_in_lanes = true;  // 2 to 12 contacts: eight regions side by side (method ags, cone, one coefficient)
};

/// What the stage reads beside the contacts.
struct RegionInputs {
    std::span<const Stencil> stencil;
    std::span<const Vec3> normal;
    std::span<const Real> gap;
    std::span<const Vec3> surface_velocity;
    std::span<const Real> static_friction, dynamic_friction, restitution;
    std::span<const Real> inverse_mass;  // by node
    std::span<const Vec3> velocity;      // by node, at the start of the step
    Real gravity = 0;                    // m/s^2, norm: scale of the error measure
    std::span<const ContactKey> key{};   // ascending; names the regions across steps. Without it there is no history to schedule by
};

struct RegionOutputs {
    std::span<Vec3> impulse;        // by contact: warm start in, solution out
    std::span<Vec3> velocity_next;  // by node: predicted in, solved out
    std::span<Vec3> push_out;       // by node
};

/// Working memory of the stage, kept between steps so that it allocates only when the step is larger than any before.
class SolverMemory {
public:
    SolverMemory();
    ~SolverMemory();
    struct Data;
    Data& data() { return *data_; }
    /// Some region of the last solve wrote push_out.
    bool pushed() const;

private:
    std::unique_ptr<Data> data_;
};

/// Solves every region to the tolerance: closed form for a single contact, else the method of the settings. Regions run as concurrent
/// jobs, largest first, small ones batched; no two write the same node. Fills iterations, error and status of the regions. Returns false
/// when there are no regions (skipped).
bool solve_regions(Executor& executor, const RegionInputs& contacts, const SolverSettings& settings, Real h, SolverMemory& memory,
                   RegionTable& regions, const RegionOutputs& out);

}  // namespace skerry
