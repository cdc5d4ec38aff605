#include "profiling/scaling/memory.h"

#include <malloc.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "engine/world/world_state.h"
#include "profiling/scaling/pile.h"

namespace skerry::profiling {

namespace {

double bytes_in_use() {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
}

void advance_by(World& world, double seconds) {
    const StepReport report = world.advance(seconds);
    if (!report.ok()) throw std::runtime_error(report.message());
}

/// Memory of a world after its first steps [bytes].
template <class Make>
double bytes_of(Make&& make) {
    const double before = bytes_in_use();
    World world = make();
    advance_by(world, 4 * world.stable_step());
    return bytes_in_use() - before;
}

World one_ball(int resolution) {
    World world({.gravity = Vec3::Zero()});
    const MaterialHandle rubber = world.add_material({.young_modulus = 5e5, .density = 1000});
    world.add_body(mesh::ball(0.1, resolution), {.material = rubber});
    return world;
}

/// Size of a row over all columns of the table [bytes].
double row_bytes(auto& table) {
    double bytes = 0;
    table.for_each_column([&](const char*, auto& column, ColumnRole) {
        bytes += sizeof(typename std::remove_reference_t<decltype(column)>::value_type);
    });
    return bytes;
}

}  // namespace

MemoryFigures measure_memory(const Mesh& ball, int balls_per_edge) {
    MemoryFigures figures;
    const auto apart = [&](int edge) {
        return bytes_of([&] { return make_pile({.balls_per_edge = edge, .gap = 1, .falls = false}, ball, 1); });
    };
    const auto tetrahedra = [&](int edge) { return edge * edge * edge * static_cast<double>(ball.tetrahedra.size()); };
    const int few = std::max(2, balls_per_edge / 2);
    const double small = apart(few), large = apart(balls_per_edge);
    figures.tetrahedron_in_balls = (large - small) / (tetrahedra(balls_per_edge) - tetrahedra(few));
    figures.fixed = small - figures.tetrahedron_in_balls * tetrahedra(few);

    constexpr int coarse = 16, fine = 32;
    const double more = bytes_of([] { return one_ball(fine); }) - bytes_of([] { return one_ball(coarse); });
    figures.tetrahedron_in_body =
        more / static_cast<double>(mesh::ball(0.1, fine).tetrahedra.size() - mesh::ball(0.1, coarse).tetrahedra.size());

    constexpr double until = 0.3;  // time at which all layers have come together [s]
    const double before = bytes_in_use();
    World pile = make_pile({.balls_per_edge = balls_per_edge}, ball, 1);
    advance_by(pile, until);
    const double of_pile = bytes_in_use() - before;
    WorldState& state = WorldAccess::state_of(pile);
    figures.contacts = state.scratch.contacts.size();
    figures.balls = static_cast<std::size_t>(balls_per_edge) * balls_per_edge * balls_per_edge;
    figures.contact = (of_pile - large) / static_cast<double>(figures.contacts);
    figures.contact_tables =
        row_bytes(state.scratch.contacts) + row_bytes(state.cache.warm_start) + row_bytes(state.cache.resting);
    return figures;
}

}  // namespace skerry::profiling
