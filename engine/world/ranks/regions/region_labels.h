// Labels of regions. Ranks that hold common bodies exchange the labels in a given number of rounds, in which they
// usually come to agree (docs/methods/ranks.md 3).
#pragma once

#include <array>
#include <span>

#include "engine/world/ranks/regions/rank_regions.h"
#include "engine/world/state/model.h"
#include "systems/contact/node_groups.h"

namespace skerry {

/// Bodies on which joints, ties and cables act. Joints, ties and cables belong to regions as contacts do.
struct JoinedBodies {
    const BodyLinks& links;
    std::array<std::span<const Index>, 5> body;  // rows of BodyTable, from JointTable, TieTable and CableTable

    static JoinedBodies bind(const Binder& binder, const Model& model) {
        return {
            .links = binder.read(model.links),
            .body = {binder.read(model.joints.first), binder.read(model.joints.second), binder.read(model.ties.first),
                     binder.read(model.ties.second), binder.read(model.cables.anchor.body)}};
    }
};

/// Nodes, and the groups of nodes that move together (NodeGroups). A unit is a set of bodies that joints, ties, cables
/// or similar rows connect (RankRegions::unit). label_regions also treats all moving nodes of a unit as one group, so
/// that one rank solves all joints, ties and cables of the unit.
struct RegionGroups {
    std::span<const Real> inverse_mass;  // by node [1/kg]
    NodeGroups groups;

    static RegionGroups bind(const Binder& binder, const Model& model) {
        binder.value(model.clusters.nodes);
        binder.value(model.clusters.body);
        binder.value(model.clusters.cluster_of);
        return {.inverse_mass = binder.read(model.nodes.inverse_mass),
                .groups = {.clusters = &model.clusters,
                           .rigid = RigidNodes::bind(binder, model.nodes, model.bodies, model.rigid_bodies)}};
    }
};

/// Sets RankRegions::unit. `bodies`: number of rows of BodyTable.
void find_units(const JoinedBodies& joined, std::size_t bodies, RankRegions& regions);

/// Joins the groups of nodes of each contact to regions, and labels these in `rounds` exchanges between the ranks
/// (docs/methods/ranks.md 3). The units of this rank are regions even without contacts.
///
/// Returns the number of rounds that were needed, the last of which changes no label on this rank; rounds + 1 if a
/// label changed in the last round.
int label_regions(const SharedBodies& bodies, const RegionGroups& nodes, std::span<const Stencil> stencil, int rounds,
                  RankRegions& regions, RankChannel& channel);

}  // namespace skerry
