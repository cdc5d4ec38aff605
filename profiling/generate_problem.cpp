#include "profiling/generate_problem.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace skerry::profiling {
namespace {

/// Random numbers that are identical with every standard library, unlike its distributions.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    Real uniform() { return static_cast<Real>(engine_() >> 11) * 0x1p-53; }
    Real symmetric(Real limit) { return limit * (2 * uniform() - 1); }
    Vec3 symmetric_vector(Real limit) {
        const Real x = symmetric(limit), y = symmetric(limit), z = symmetric(limit);
        return {x, y, z};
    }
    Real normal() {  // Box-Muller transform
        const Real radius = std::sqrt(-2 * std::log(1 - uniform()));
        return radius * std::cos(2 * std::numbers::pi * uniform());
    }

private:
    std::mt19937_64 engine_;
};

struct Sheet {
    Index first;             // index of its first node
    Index nodes;             // number of nodes along an edge
    Real spacing;            // edge length, in fine edges
    std::vector<Real> x, y;  // positions of its nodes, moved at random

    Index node(Index i, Index j) const { return first + i * nodes + j; }
};

Sheet add_sheet(const SheetSettings& settings, Index number, Random& random, LumpedContacts& out) {
    const bool upper = number % 2 == 1;
    const Index fine = settings.coarse * (settings.nodes - 1) + 1;
    Sheet sheet{.first = static_cast<Index>(out.inverse_mass.size()),
                .nodes = upper ? settings.nodes : fine,
                .spacing = upper ? static_cast<Real>(settings.coarse) : 1,
                .x = {},
                .y = {}};
    const bool fixed = settings.stacked && number == 0;
    const bool moves = settings.stacked ? !fixed : upper;
    const Vec3 mean = !moves ? Vec3(Vec3::Zero()) : settings.stacked ? Vec3(0.2, 0, -1) : Vec3(0.4, 0.1, -1);
    const Real noise = fixed ? 0 : settings.stacked ? 0.1 : 0.15;
    for (Index i = 0; i < sheet.nodes; ++i)
        for (Index j = 0; j < sheet.nodes; ++j) {
            sheet.x.push_back(sheet.spacing * (i + random.symmetric(0.25)));
            sheet.y.push_back(sheet.spacing * (j + random.symmetric(0.25)));
            // The mass of a node is proportional to the area that it covers.
            const Real mass =
                std::exp(0.5 * random.normal()) * sheet.spacing * sheet.spacing * (upper ? settings.mass_ratio : 1);
            out.inverse_mass.push_back(fixed ? 0 : 1 / mass);
            out.velocity.push_back(mean + random.symmetric_vector(noise));
        }
    return sheet;
}

/// Adds contacts of the interior nodes of `from` with the triangles of `to`. The triangles are those of a regular grid:
/// only the positions of the interior nodes are random.
void add_contacts(const Sheet& from, const Sheet& to, const Vec3& up, const SheetSettings& settings, Random& random,
                  LumpedContacts& out) {
    for (Index i = 1; i + 1 < from.nodes; ++i)
        for (Index j = 1; j + 1 < from.nodes; ++j) {
            const std::size_t local = static_cast<std::size_t>(i * from.nodes + j);
            const Real x = from.x[local] / to.spacing, y = from.y[local] / to.spacing;
            const Index a = std::clamp(static_cast<Index>(x), 0, to.nodes - 2),
                        b = std::clamp(static_cast<Index>(y), 0, to.nodes - 2);
            const Real u = std::clamp(x - a, 0.0, 1.0), v = std::clamp(y - b, 0.0, 1.0);
            const bool low = u + v <= 1;
            const Index corner = low ? to.node(a, b) : to.node(a + 1, b + 1);
            const Index along_u = low ? to.node(a + 1, b) : to.node(a, b + 1),
                        along_v = low ? to.node(a, b + 1) : to.node(a + 1, b);
            const Real share_u = low ? u : 1 - u, share_v = low ? v : 1 - v;
            const std::array<Index, 4> node = {from.node(i, j), corner, along_u, along_v};
            const auto moves = [&](Index n) { return out.inverse_mass[n] > 0; };
            if (std::ranges::none_of(node, moves)) continue;
            out.node.push_back(node);
            out.weight.push_back({1, -(1 - share_u - share_v), -share_u, -share_v});
            out.normal.push_back((up + random.symmetric_vector(settings.tilt)).normalized());
            out.offset.push_back(Vec3::Zero());
            out.friction.push_back(settings.friction);
        }
}

}  // namespace

LumpedContacts generate_sheets(const SheetSettings& settings) {
    Random random(settings.seed);
    LumpedContacts out;
    std::vector<Sheet> sheets;
    for (Index s = 0; s < settings.sheets; ++s) sheets.push_back(add_sheet(settings, s, random, out));
    for (std::size_t s = 0; s + 1 < sheets.size(); ++s) {
        add_contacts(sheets[s + 1], sheets[s], Vec3::UnitZ(), settings, random, out);
        add_contacts(sheets[s], sheets[s + 1], -Vec3::UnitZ(), settings, random, out);
    }
    return out;
}

std::vector<NamedContacts> generate_problems(bool quick) {
    struct Named {
        const char* name;
        SheetSettings settings;
        bool large = false;
    };
    const Named all[] = {
        {"patch-8", {.nodes = 4}},
        {"patch-200", {.nodes = 12}},
        {"patch-200-mass-ratio-1000", {.nodes = 12, .mass_ratio = 1000}},
        {"patch-200-tilted", {.nodes = 12, .tilt = 0.6, .friction = 0.8}},
        {"coarse-8-533", {.nodes = 4, .coarse = 8}, true},
        {"stack-6-layers-160", {.sheets = 6, .nodes = 6, .stacked = true}, true},
        {"stack-5-layers-800", {.sheets = 5, .nodes = 12, .stacked = true}, true},
        {"patch-2888", {.nodes = 40}, true},
    };
    std::vector<NamedContacts> problems;
    for (const Named& named : all)
        if (!quick || !named.large) problems.push_back({named.name, generate_sheets(named.settings)});
    return problems;
}

}  // namespace skerry::profiling
