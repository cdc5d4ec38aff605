#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "profiling/generate_problem.h"
#include "profiling/lab/algorithm_1.h"
#include "profiling/measure.h"
#include "profiling/separation.h"
#include "systems/contact/separate_regions.h"

namespace skerry::profiling {
namespace {

/// Writes a line of the table. The paper's algorithm takes quadratic time, so both are timed only once.
void compare(const std::string& name, const LumpedContacts& contacts, std::ofstream& csv) {
    std::vector<Stencil> stencil;
    for (std::size_t i = 0; i < contacts.node.size(); ++i) stencil.push_back({contacts.node[i], contacts.weight[i]});
    std::vector<Index> region(stencil.size()), area(stencil.size());
    RegionTable regions;
    SeparationMemory memory;
    const auto executor = make_executor(Backend::serial, 1);
    const double start = wall_seconds();
    separate_regions(*executor, stencil, contacts.inverse_mass, NodeGroups{}, ContactRegions::separate, memory, regions,
                     region);
    const double separated = wall_seconds();
    const Index areas = lab::label_by_algorithm_1(stencil, contacts.inverse_mass, area);
    const double labelled = wall_seconds();
    csv << name << ',' << stencil.size() << ',' << regions.size() << ',' << areas << ','
        << lab::count_shared_nodes(stencil, contacts.inverse_mass, area) << ',' << separated - start << ','
        << labelled - separated << '\n';
}

}  // namespace

void profile_algorithm_1(const SeparationOptions& options, const std::vector<StepProblem>& steps) {
    std::ofstream csv(options.out / "algorithm_1.csv");
    csv << "problem,contacts,regions,areas,pairs_of_areas_that_share_a_node,seconds_separate,seconds_algorithm_1\n";
    std::fprintf(stderr, "\r\033[KAlgorithm 1, %zu steps", steps.size());
    for (const StepProblem& step : steps) compare(step.problem.name, step.lumped, csv);
    for (const NamedContacts& named : generate_problems(true)) compare(named.name, named.contacts, csv);
}

}  // namespace skerry::profiling
