#include <cstdio>
#include <fstream>

#include "profiling/generate_problem.h"
#include "profiling/measure.h"
#include "profiling/separation.h"
#include "systems/contact/separate_regions.h"
#include "systems/solver/solve_regions.h"

namespace skerry::profiling {
namespace {

/// Small piles side by side, each a region of eight contacts, as the stages of a step see them.
struct Piles {
    GeneratedContacts contacts;
    std::vector<Vec3> zeros;     // by contact: velocity of surfaces
    std::vector<Real> none;      // by contact: gap, restitution
    std::vector<Vec3> impulse;   // by contact
    std::vector<Vec3> velocity;  // by node
    std::vector<Vec3> push_out;  // by node
    std::vector<Index> region_of;

    explicit Piles(Index piles) {
        constexpr int kinds = 16;  // different piles; then they repeat
        std::vector<GeneratedContacts> kind;
        for (int k = 0; k < kinds; ++k) kind.push_back(generate_sheets({.nodes = 4, .seed = static_cast<std::uint64_t>(k + 1)}));
        for (Index p = 0; p < piles; ++p) append(kind[static_cast<std::size_t>(p % kinds)]);
        const std::size_t count = contacts.stencil.size();
        zeros.assign(count, Vec3::Zero());
        none.assign(count, 0);
        impulse.assign(count, Vec3::Zero());
        region_of.assign(count, 0);
        velocity = contacts.velocity;
        push_out.assign(velocity.size(), Vec3::Zero());
    }

    void append(const GeneratedContacts& pile) {
        const Index first = static_cast<Index>(contacts.inverse_mass.size());
        for (Stencil stencil : pile.stencil) {
            for (Index& node : stencil.node) node += first;
            contacts.stencil.push_back(stencil);
        }
        const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        add(contacts.normal, pile.normal);
        add(contacts.friction, pile.friction);
        add(contacts.inverse_mass, pile.inverse_mass);
        add(contacts.velocity, pile.velocity);
    }

    /// The state before a solve, cold.
    void reset() {
        velocity = contacts.velocity;
        std::ranges::fill(impulse, Vec3::Zero());
    }

    RegionInputs inputs() const {
        return {.stencil = contacts.stencil,
                .normal = contacts.normal,
                .gap = none,
                .surface_velocity = zeros,
                .static_friction = contacts.friction,
                .dynamic_friction = contacts.friction,
                .restitution = none,
                .inverse_mass = contacts.inverse_mass,
                .velocity = contacts.velocity,
                .gravity = 9.81};
    }
    RegionOutputs outputs() { return {.impulse = impulse, .velocity_next = velocity, .push_out = push_out}; }
};

constexpr Real step_size = 1e-3;  // s; with gaps of zero it says nothing

struct Stages {
    Piles piles;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    UnionFind union_find;
    SolverMemory memory;
    RegionTable regions;

    explicit Stages(Index count) : piles(count) {}

    double separate(ContactRegions mode) {
        return timed(
            [] {},
            [&] { separate_regions(piles.contacts.stencil, piles.contacts.inverse_mass, mode, union_find, regions, piles.region_of); });
    }
    double solve(const SolverSettings& settings) {
        return timed([&] { piles.reset(); },
                     [&] { solve_regions(*executor, piles.inputs(), settings, step_size, memory, regions, piles.outputs()); });
    }
};

Index most_iterations(const RegionTable& regions) {
    return regions.iterations.empty() ? 0 : *std::ranges::max_element(regions.iterations);
}

void profile_regions_of_one_size(const SeparationOptions& options) {
    std::ofstream csv(options.out / "growth.csv");
    csv << "contacts,mode,method,seconds_separate,seconds_solve,iterations\n";
    const Index largest = options.quick ? 10000 : 100000;
    for (const Index contacts : {100, 300, 1000, 3000, 10000, 30000, 100000}) {
        if (contacts > largest) break;
        std::fprintf(stderr, "\r\033[Kregions of eight contacts, %d contacts", contacts);
        Stages stages(contacts / 8);
        const Index count = static_cast<Index>(stages.piles.contacts.stencil.size());
        for (const SolverMethod method : {SolverMethod::pgs, SolverMethod::pcg_pgs})
            for (const ContactRegions mode : {ContactRegions::separate, ContactRegions::global}) {
                std::vector<double> separate, solve;
                const SolverSettings settings{.method = method};
                for (int round = 0; round < 3; ++round) {
                    separate.push_back(stages.separate(mode));
                    solve.push_back(stages.solve(settings));
                }
                csv << count << ',' << name_of(mode) << ',' << name_of(method) << ',' << median(separate) << ',' << median(solve) << ','
                    << most_iterations(stages.regions) << '\n';
            }
    }
}

/// One sweep is the difference of runs that do n and 2 n of them: loading and writing back are in both.
void profile_sweep(const SeparationOptions& options) {
    std::ofstream csv(options.out / "sweep.csv");
    csv << "contacts,seconds_separate,seconds_sweep\n";
    const Index largest = options.quick ? 30000 : 1000000;
    constexpr Index sweeps = 10;
    for (const Index contacts : {100, 1000, 10000, 30000, 100000, 300000, 1000000}) {
        if (contacts > largest) break;
        std::fprintf(stderr, "\r\033[Kseparation against a sweep, %d contacts", contacts);
        Stages stages(contacts / 8);
        std::vector<double> separate, sweep;
        SolverSettings once{.method = SolverMethod::pgs, .max_iterations = sweeps, .fixed_iterations = true};
        SolverSettings twice = once;
        twice.max_iterations = 2 * sweeps;
        for (int round = 0; round < 3; ++round) {
            // one region of all: the sweep runs through memory as the separation does
            separate.push_back(stages.separate(ContactRegions::separate));
            stages.separate(ContactRegions::global);
            const double first = stages.solve(once);
            sweep.push_back((stages.solve(twice) - first) / sweeps);
        }
        csv << stages.piles.contacts.stencil.size() << ',' << median(separate) << ',' << median(sweep) << '\n';
    }
}

}  // namespace

void profile_growth(const SeparationOptions& options) {
    profile_regions_of_one_size(options);
    profile_sweep(options);
}

}  // namespace skerry::profiling
