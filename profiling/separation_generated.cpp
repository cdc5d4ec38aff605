#include <cstdio>
#include <fstream>

#include "profiling/generate_problem.h"
#include "profiling/lumped_solver.h"
#include "profiling/measure.h"
#include "profiling/separation.h"

namespace skerry::profiling {
namespace {

/// Makes small piles side by side, each a region of eight contacts.
LumpedContacts make_piles(Index piles) {
    constexpr int kinds = 16;  // number of different piles, which then repeat
    std::vector<LumpedContacts> kind;
    for (int k = 0; k < kinds; ++k)
        kind.push_back(generate_sheets({.nodes = 4, .seed = static_cast<std::uint64_t>(k + 1)}));
    LumpedContacts all;
    for (Index p = 0; p < piles; ++p) {
        const LumpedContacts& pile = kind[static_cast<std::size_t>(p % kinds)];
        const Index first = static_cast<Index>(all.inverse_mass.size());
        for (std::array<Index, 4> nodes : pile.node) {
            for (Index& node : nodes) node += first;
            all.node.push_back(nodes);
        }
        const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        add(all.weight, pile.weight);
        add(all.normal, pile.normal);
        add(all.offset, pile.offset);
        add(all.friction, pile.friction);
        add(all.inverse_mass, pile.inverse_mass);
        add(all.velocity, pile.velocity);
    }
    return all;
}

/// Separation and solution of the piles.
struct Stages {
    explicit Stages(Index piles) : solver(make_piles(piles)) {}

    double separate(ContactRegions mode) {
        return timed([] {}, [&] { solver.separate(mode); });
    }
    double solve(const SolverSettings& settings) {
        return timed([&] { solver.reset(); }, [&] { solver.solve(settings); });
    }
    std::size_t contacts() const { return solver.impulse().size(); }

    LumpedSolver solver;
};

void profile_regions_of_one_size(const SeparationOptions& options) {
    std::ofstream csv(options.out / "growth.csv");
    csv << "contacts,mode,method,seconds_separate,seconds_solve,iterations\n";
    const Index largest = options.quick ? 10000 : 100000;
    for (const Index contacts : {100, 300, 1000, 3000, 10000, 30000, 100000}) {
        if (contacts > largest) break;
        std::fprintf(stderr, "\r\033[Kregions of eight contacts, %d contacts", contacts);
        Stages stages(contacts / 8);
        const std::size_t count = stages.contacts();
        for (const SolverMethod method : {SolverMethod::pgs, SolverMethod::pcg_pgs})
            for (const ContactRegions mode : {ContactRegions::separate, ContactRegions::global}) {
                std::vector<double> separate, solve;
                const SolverSettings settings{.method = method};
                for (int round = 0; round < 3; ++round) {
                    separate.push_back(stages.separate(mode));
                    solve.push_back(stages.solve(settings));
                }
                csv << count << ',' << name_of(mode) << ',' << name_of(method) << ',' << median(separate) << ','
                    << median(solve) << ',' << stages.solver.most_iterations() << '\n';
            }
    }
}

/// Measures one sweep as the difference of runs of n and 2 n sweeps: loading and writing back are in both.
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
            // All contacts form one region: the sweep then runs through memory like the separation.
            separate.push_back(stages.separate(ContactRegions::separate));
            stages.separate(ContactRegions::global);
            const double first = stages.solve(once);
            sweep.push_back((stages.solve(twice) - first) / sweeps);
        }
        csv << stages.contacts() << ',' << median(separate) << ',' << median(sweep) << '\n';
    }
}

}  // namespace

void profile_growth(const SeparationOptions& options) {
    profile_regions_of_one_size(options);
    profile_sweep(options);
}

}  // namespace skerry::profiling
