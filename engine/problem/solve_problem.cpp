#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>

#include "components/union_find.h"
#include "engine/base/complaint.h"
#include "engine/problem/check_arrays.h"
#include "engine/problem/measure_problem.h"
#include "engine/problem/solve_by_region.h"
#include "skerry/problem.h"
#include "systems/solver/methods/run_method.h"

namespace skerry {
namespace {

BlockSystem view(const ContactProblem& problem) {
    return {problem.row_offset, problem.column, problem.block, problem.q, problem.mu};
}

/// Contacts grouped by region. Contacts that a block of W couples are in the same region. Regions are numbered in the
/// order of their first contacts.
struct ProblemRegions {
    std::vector<Index> offset, contact;
    UnionFind joined;  // union-find structure that joins contacts coupled by a block of W

    Index size() const { return static_cast<Index>(offset.size()) - 1; }
    std::span<const Index> operator[](Index region) const {
        return {contact.data() + offset[region], static_cast<std::size_t>(offset[region + 1] - offset[region])};
    }
};

void separate(const ContactProblem& problem, ProblemRegions& regions) {
    const std::size_t count = problem.q.size();
    UnionFind& joined = regions.joined;
    joined.start(count);
    for (std::size_t i = 0; i < count; ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            joined.join(static_cast<Index>(i), problem.column[k]);
    // A first pass over the contacts numbers the regions and counts their contacts. A second pass stores the contacts
    // by region. It moves each offset to the start of the next region, so the offsets are shifted back afterwards.
    regions.offset.assign(1, 0);
    for (Index i = 0; i < static_cast<Index>(count); ++i) {
        const Index region = joined.number(i);
        regions.offset.resize(static_cast<std::size_t>(joined.number_count) + 1);
        ++regions.offset[region + 1];
    }
    std::partial_sum(regions.offset.begin(), regions.offset.end(), regions.offset.begin());
    regions.contact.resize(count);
    for (Index i = 0; i < static_cast<Index>(count); ++i) regions.contact[regions.offset[joined.number(i)]++] = i;
    for (Index r = regions.size(); r > 0; --r) regions.offset[r] = regions.offset[r - 1];
    regions.offset[0] = 0;
}

/// Results and working memory of a solve. Repetitions of the solve reuse the memory.
struct Work {
    ProblemRegions regions;
    BlockMemory memory;
    std::vector<Index> used;  // number of iterations that each region needed
};

/// Solves all regions. The tolerance applies to the norm of the errors of all regions together. Each region gets a
/// share of it proportional to the square root of its number of contacts, because squares of norms add up.
void solve_once(const ContactProblem& problem, const ProblemSettings& settings, const BlockMethod& method, Work& work) {
    const ProblemRegions& regions = work.regions;
    separate(problem, work.regions);
    work.memory.prepare(view(problem), regions.contact);
    work.used.assign(static_cast<std::size_t>(regions.size()), 0);
    SolveLimits limits;
    limits.tolerance = settings.tolerance;
    limits.relaxation = settings.relaxation;
    BlockOperator whole(work.memory, 0, problem.contacts(), settings.friction, 0);
    if (whole.error() <= settings.tolerance) return;
    constexpr int round_limit = 8;
    for (int round = 0; round < round_limit; ++round) {
        for (Index region = 0; region < regions.size(); ++region) {
            const Index begin = regions.offset[region], end = regions.offset[region + 1];
            const Real share = whole.measured_size() *
                               std::sqrt(static_cast<Real>(end - begin) / static_cast<Real>(problem.contacts()));
            BlockOperator op(work.memory, begin, end, settings.friction, share);
            limits.max_iterations = settings.max_iterations - work.used[region];
            if (limits.max_iterations <= 0 || (round > 0 && op.error() <= limits.tolerance)) continue;
            work.used[region] += method(op, limits).iterations;
        }
        if (whole.error() <= settings.tolerance) return;
        // The error is relative to norms of the solution, which are known only now.
        limits.tolerance /= 2;
    }
}

/// Returns the impulses, sorted like the contacts of the problem.
std::vector<Vec3> reactions(const Work& work) {
    std::vector<Vec3> reaction(work.regions.contact.size());
    for (std::size_t i = 0; i < reaction.size(); ++i)
        reaction[work.regions.contact[i]] = work.memory.impulse[i].head<3>();
    return reaction;
}

double seconds_of(const ContactProblem& problem, const ProblemSettings& settings, const BlockMethod& method,
                  Work& work) {
    const auto start = std::chrono::steady_clock::now();
    solve_once(problem, settings, method, work);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check(const ContactProblem& problem, const ProblemSettings& settings) {
    const std::string title = title_of(problem);
    if (!(settings.tolerance >= 0)) refuse(title, "tolerance", std::to_string(settings.tolerance), "a number >= 0");
    if (settings.max_iterations < 1)
        refuse(title, "max_iterations", std::to_string(settings.max_iterations), "an integer >= 1");
    if (!(settings.relaxation > 0 && settings.relaxation < 2))
        refuse(title, "relaxation", std::to_string(settings.relaxation), "a number > 0 and < 2");
}

}  // namespace

ProblemSolution solve_by_region(const ContactProblem& problem, const ProblemSettings& settings,
                                const BlockMethod& method) {
    check_arrays(problem);
    check(problem, settings);
    Work work;
    const double first = seconds_of(problem, settings, method, work);
    // A solve shorter than `long_enough` is repeated for about the time `budget` [s], because the first run is slowed
    // down by memory allocation and cold caches, and the clock is coarse. The reported time is the median.
    constexpr double long_enough = 5e-3, budget = 20e-3;
    std::vector<double> seconds{first};
    while (first < long_enough && seconds.size() < 1001 &&
           std::accumulate(seconds.begin(), seconds.end(), 0.0) < budget)
        seconds.push_back(seconds_of(problem, settings, method, work));
    std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2), seconds.end());

    ProblemSolution solution;
    solution.reaction = reactions(work);
    const ProblemError error = measure_problem(problem, solution.reaction, settings.friction);
    solution.regions = work.regions.size();
    solution.iterations = work.used.empty() ? 0 : *std::max_element(work.used.begin(), work.used.end());
    solution.seconds = seconds[seconds.size() / 2];
    solution.error = error.relative;
    solution.error_absolute = error.absolute;
    solution.error_over_q = error.over_q;
    solution.energy_gap = error.energy_gap;
    solution.converged = error.relative <= settings.tolerance;
    for (Index region = 0; region < work.regions.size(); ++region) {
        solution.largest_region = std::max(solution.largest_region, static_cast<Index>(work.regions[region].size()));
        solution.unconverged += !solution.converged && work.used[region] >= settings.max_iterations;
    }
    return solution;
}

ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings) {
    return solve_by_region(problem, settings, [&settings](BlockOperator& op, const SolveLimits& limits) {
        return run_method(settings.method, op, limits);
    });
}

}  // namespace skerry
