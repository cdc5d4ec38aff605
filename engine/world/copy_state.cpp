#include "engine/world/copy_state.h"

#include <cstring>

namespace skerry {

namespace {

/// Columns that are not state get bits that no result survives: what is derived has to be rebuilt, and what is scratch
/// to be written before it is read.
struct Spoil {
    void operator()(const char*, auto& column, ColumnRole role) const {
        if (is_state(role)) return;
        for (auto& row : column) std::memset(static_cast<void*>(&row), 0xff, sizeof row);
    }
};

void copy_pairs(const PairTable& from, PairTable& to) {
    to = PairTable{};
    to.key = from.key;
    to.kind = from.kind;
    to.first = from.first;
    to.second = from.second;
    to.state = from.state;
}

}  // namespace

void copy_state(WorldState& from, WorldState& to) {
    from.settle();
    to.settle();
    const Backend backend = to.model.settings.backend;
    const int threads = to.model.settings.threads;
    from.cache.forget_distances(from.model);

    to.model = from.model;
    to.model.settings.backend = backend;
    to.model.settings.threads = threads;
    to.model.for_each_table([](const char*, auto& table) { table.for_each_column(Spoil{}); });
    // What an element whose law has none of it leaves there comes back when the two are swapped.
    to.model.elements.rotation_next = from.model.elements.rotation_next;
    to.model.elements.viscous_strain_next = from.model.elements.viscous_strain_next;
    to.clock = from.clock;
    to.cache = {};
    to.cache.warm_start = from.cache.warm_start;
    copy_pairs(from.cache.pairs, to.cache.pairs);
    to.scratch.parameters = step_parameters(to.model.settings);

    to.model.rebuild_outlines();
    to.model.rebuild_derived();
    to.cache.forget_distances(to.model);
    to.record.balance.close();
    to.scratch.contacts.resize(0);
    to.scratch.regions = {};
    to.record.contact_view_is_current = false;
}

}  // namespace skerry
