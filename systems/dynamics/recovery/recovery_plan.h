// Plan of the recovery of fields at nodes: all data that do not depend on the deformation of the body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/ragged.h"
#include "components/types.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/recovery/surface_gradient.h"

namespace skerry {

/// A body at rest and its elements. Nodes and tetrahedra are numbered within the body.
struct RecoveryMesh {
    ElementInputs elements;
    Range blocks;  // element blocks of the body
    ElementCover cover;
    std::span<const std::array<Index, 4>> tetrahedra;
    std::span<const std::array<Index, 3>> surface;  // outward triangles
    std::span<const Index> material_of_tetrahedra;  // empty if all tetrahedra have one material
    std::span<const Vec3> rest_position;            // nodes of the body, in the frame of the mesh [m]
    Index first_node;                               // first node of the body in the node numbers of `elements`
};

/// Plan of recover_nodes for some nodes of a body. Blocks are counted from the first block of the body, so that a plan
/// stays valid when the rows of the body move in the tables. A *place* p is the number of an element: lane p %
/// element_lanes of the block `block[p / element_lanes]`. Vectors are in the frame of the element gradients.
struct RecoveryPlan {
    std::vector<Index> nodes;  // nodes to recover, in the order of the results
    std::vector<Index> block;  // blocks whose elements are needed, ascending
    std::vector<Vec3> center;  // by place: centroid of the tetrahedra that the element covers [m]

    /// Term of a weighted sum: `factor` times the value with the index `from`.
    struct Term {
        Index from;
        Real factor;
    };
    // Row in `faces` of each needed node that is inside the body or on a smooth part of its surface; no_index for inner
    // nodes, and for nodes of materials that yield. With no_index the value at the node is a weighted sum of values of
    // the elements around it, else the result of Newton's method.
    std::vector<Index> face_of_smooth_node;
    // Factors of the elements around the node of each row of `face_of_smooth_node`, by place, ascending. `strained`:
    // elements with strain. `volumetric`: elements that have only the volumetric part of the stress.
    //
    // Factors of a fit for a node without a row of `faces`, else factors of a mean. The mean starts Newton's method,
    // and replaces its result if the method fails.
    Ragged<Term> strained, volumetric;

    struct Face {
        SurfaceAround around;
        Index element;  // place of one element around the node; gives the material
        // Weight and inertia of the face's node, estimated as this multiple of the sum of the forces at the inner nodes
        // in the tetrahedra around it. It is the volume of the face's node (NodePatches::node_volume) divided by the
        // sum of the volumes of these inner nodes; 0 if there are none.
        Real inner_share;
    };
    std::vector<Face> faces;
    Ragged<SurfaceTriangle> triangles;  // by face
    // For each face: numbers (Corner::row) of the nodes whose force is needed; first the number of the face's own node,
    // then the numbers of the inner nodes in the tetrahedra around this node.
    Ragged<Index> force_rows;
    /// Corner of an element at a node whose force is needed.
    struct Corner {
        Index element, corner;
        Index row;  // number of the node among those whose force is needed
    };
    std::vector<Corner> corners;  // ascending by place
    std::size_t force_count = 0;  // number of nodes whose force is needed

    // For each of `nodes`: its row of `face_of_smooth_node`, or no_index for a node at an edge, corner or interface of
    // materials. The value of such a node is extrapolated.
    std::vector<Index> smooth_of;
    // Terms of the sums that give the extrapolated values. `donors`: Term::from is a row of face_of_smooth_node.
    // `strained_around`, `volumetric_around`: Term::from is a place; these terms are used only for materials with too
    // few donors for a fit.
    Ragged<Term> donors, strained_around, volumetric_around;
};

RecoveryPlan plan_recovery(const RecoveryMesh& body, std::span<const Index> nodes);

}  // namespace skerry
