#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>

#include "skerry/error.h"
#include "skerry/problem.h"
#include "systems/solver/methods/run_method.h"
#include "systems/solver/operators/block_operator.h"

namespace skerry {
namespace {

BlockSystem view(const ContactProblem& problem) {
    return {problem.row_offset, problem.column, problem.block, problem.q, problem.mu};
}

/// Contacts by region: joined by a block. The smaller number wins, so that regions are numbered by their first contact.
struct ProblemRegions {
    std::vector<Index> offset, contact;
    std::vector<Index> root;

    Index size() const { return static_cast<Index>(offset.size()) - 1; }
    std::span<const Index> operator[](Index region) const {
        return {contact.data() + offset[region], static_cast<std::size_t>(offset[region + 1] - offset[region])};
    }
};

void separate(const ContactProblem& problem, ProblemRegions& regions) {
    const std::size_t count = problem.q.size();
    std::vector<Index>& root = regions.root;
    root.resize(count);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](Index i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (std::size_t i = 0; i < count; ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k) {
            const Index a = find(static_cast<Index>(i)), b = find(problem.column[k]);
            root[std::max(a, b)] = std::min(a, b);
        }
    // roots are smaller than what they stand for: one pass numbers the regions, one sorts the contacts by them
    Index region_count = 0;
    for (std::size_t i = 0; i < count; ++i) root[i] = root[i] == static_cast<Index>(i) ? region_count++ : root[root[i]];
    regions.offset.assign(static_cast<std::size_t>(region_count) + 1, 0);
    for (const Index region : root) ++regions.offset[region + 1];
    std::partial_sum(regions.offset.begin(), regions.offset.end(), regions.offset.begin());
    regions.contact.resize(count);
    for (std::size_t i = 0; i < count; ++i) regions.contact[regions.offset[root[i]]++] = static_cast<Index>(i);
    for (Index r = region_count; r > 0; --r) regions.offset[r] = regions.offset[r - 1];
    regions.offset[0] = 0;
}

struct Measured {
    ProblemError error;
    Real size = 0;  // max(|q|, |r|, |u|)
};

Measured measure(const ContactProblem& problem, std::span<const Vec3> reaction, Friction friction) {
    Real lack = 0, q = 0, r = 0, u = 0;
    for (std::size_t i = 0; i < problem.q.size(); ++i) {
        Vec3 velocity = problem.q[i];
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            velocity += problem.block[k] * reaction[problem.column[k]];
        lack += natural_map(reaction[i], velocity, problem.mu[i], friction).squaredNorm();
        q += problem.q[i].squaredNorm();
        r += reaction[i].squaredNorm();
        u += velocity.squaredNorm();
    }
    const Real size = std::sqrt(std::max({q, r, u}));
    if (lack == 0) return {{0, 0, 0}, size};
    return {{std::sqrt(lack), std::sqrt(lack) / size, std::sqrt(lack / q)}, size};
}

/// Everything that a solve writes, kept from one repetition to the next.
struct Work {
    ProblemRegions regions;
    BlockMemory memory;
    std::vector<Index> used;  // iterations by region
};

/// Solves all regions. The error is one of all regions together, so none is asked for more than its share of it; since the sizes that it
/// is measured against are known at the end only, the regions may have to go on from where they are, asked for half.
void solve_once(const ContactProblem& problem, const ProblemSettings& settings, Work& work) {
    const BlockSystem system = view(problem);
    separate(problem, work.regions);
    work.memory.prepare(system);
    work.used.assign(static_cast<std::size_t>(work.regions.size()), 0);
    SolveLimits limits;
    limits.tolerance = settings.tolerance;
    Real size = measure(problem, work.memory.impulse, settings.friction).size;
    const Real contacts = static_cast<Real>(problem.contacts());
    constexpr int round_limit = 8;
    for (int round = 0; round < round_limit; ++round) {
        for (Index region = 0; region < work.regions.size(); ++region) {
            const std::span<const Index> rows = work.regions[region];
            const Real share = size * std::sqrt(static_cast<Real>(rows.size()) / contacts);
            BlockOperator op(system, rows, settings.friction, share, work.memory);
            limits.max_iterations = settings.max_iterations - work.used[region];
            if (limits.max_iterations <= 0 || op.error() <= limits.tolerance) continue;
            work.used[region] += run_method(settings.method, op, limits).iterations;
        }
        const Measured now = measure(problem, work.memory.impulse, settings.friction);
        if (now.error.relative <= settings.tolerance) return;
        size = now.size;
        limits.tolerance /= 2;
    }
}

double seconds_of(const ContactProblem& problem, const ProblemSettings& settings, Work& work) {
    const auto start = std::chrono::steady_clock::now();
    solve_once(problem, settings, work);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check(const ContactProblem& problem, const ProblemSettings& settings) {
    const std::size_t count = problem.q.size();
    const auto expect = [&](bool good, const char* field, const std::string& found, const std::string& expected) {
        if (!good)
            Complaint{.file = {}, .object = "problem " + problem.name, .field = field, .found = found, .expected = expected, .hint = {}}
                .raise();
    };
    expect(problem.mu.size() == count, "mu", std::to_string(problem.mu.size()) + " values", std::to_string(count));
    expect(problem.row_offset.size() == count + 1, "row_offset", std::to_string(problem.row_offset.size()) + " values",
           std::to_string(count + 1));
    const std::size_t blocks = problem.block.size();
    expect(problem.column.size() == blocks && static_cast<std::size_t>(problem.row_offset.back()) == blocks, "column",
           std::to_string(problem.column.size()) + " values", std::to_string(blocks) + " (blocks)");
    for (const Index column : problem.column)
        expect(column >= 0 && static_cast<std::size_t>(column) < count, "column", std::to_string(column), "a contact");
    expect(settings.tolerance >= 0, "tolerance", std::to_string(settings.tolerance), ">= 0");
    expect(settings.max_iterations >= 1, "max_iterations", std::to_string(settings.max_iterations), ">= 1");
}

}  // namespace

ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings) {
    check(problem, settings);
    Work work;
    const double first = seconds_of(problem, settings, work);
    // a short solve is repeated: the first pays for memory and cold caches, and the clock is coarse
    constexpr double long_enough = 5e-3, budget = 20e-3;
    std::vector<double> seconds{first};
    while (first < long_enough && seconds.size() < 1001 && std::accumulate(seconds.begin(), seconds.end(), 0.0) < budget)
        seconds.push_back(seconds_of(problem, settings, work));
    std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2), seconds.end());

    ProblemSolution solution;
    const ProblemError error = measure(problem, work.memory.impulse, settings.friction).error;
    solution.reaction = work.memory.impulse;
    solution.regions = work.regions.size();
    solution.iterations = work.used.empty() ? 0 : *std::max_element(work.used.begin(), work.used.end());
    solution.seconds = seconds[seconds.size() / 2];
    solution.error = error.relative;
    solution.error_absolute = error.absolute;
    solution.error_over_q = error.over_q;
    solution.converged = error.relative <= settings.tolerance;
    return solution;
}

ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction) {
    if (reaction.size() != problem.q.size())
        Complaint{.file = {},
                  .object = "problem " + problem.name,
                  .field = "reaction",
                  .found = std::to_string(reaction.size()) + " values",
                  .expected = std::to_string(problem.q.size()),
                  .hint = {}}
            .raise();
    return measure(problem, reaction, Friction::cone).error;
}

}  // namespace skerry
