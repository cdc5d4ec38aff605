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
/// stays valid when the rows of the body move in the tables. A place is the index of a lane in the listed blocks.
/// Lengths are measured in the frame of the element gradients.
struct RecoveryPlan {
    std::vector<Index> nodes;  // nodes to recover, in the order of the results
    std::vector<Index> block;  // blocks whose elements are needed, ascending
    std::vector<Vec3> center;  // by place: centroid of the tetrahedra that the element covers [m]

    /// Inner node, or node of a smooth part of the surface. Its value is found from the elements around it.
    struct SmoothNode {
        Vec3 rest;          // rest position [m]
        Real size;          // largest distance of the centroid of an element around the node [m]
        bool is_quadratic;  // true for a quadratic fit, false for a linear fit
        Index face;         // row of `faces`; no_index for an inner node
    };
    std::vector<SmoothNode> smooth;
    // For each row of `smooth`: places of the elements around its node, ascending. `strained`: elements with strain.
    // `volumetric`: elements that have only the volumetric part of the stress.
    Ragged<Index> strained, volumetric;

    struct Face {
        SurfaceAround around;
        Index place;  // place of any element around the node
        // Volume of the node divided by the volume of the inner nodes of the tetrahedra around it; 0 if there are none.
        Real inner_share;
    };
    std::vector<Face> faces;
    Ragged<SurfaceTriangle> triangles;  // by face
    // Rows of `corners` for each face: first the row of the face's own node, then the rows of the inner nodes of the
    // tetrahedra around this node.
    Ragged<Index> force;
    /// Corner of an element.
    struct Corner {
        Index place, corner;
    };
    Ragged<Corner> corners;  // for each node whose force is needed: all corners of elements at the node

    /// Linear fit at an edge, corner or interface of materials, for the elements of one material.
    struct Extrapolation {
        Real volume;         // quarter of the volume of the tetrahedra of this material around the node [m^3]
        Real size;           // largest distance of a donor from the node [m]
        bool is_determined;  // false if the donors do not suffice for a fit
    };
    std::vector<Extrapolation> extrapolations;
    Ragged<Index> donors;  // by extrapolation: rows of `smooth` whose values the fit uses
    // Places of the elements of the material around the node of each extrapolation, as in `strained` and `volumetric`.
    // They are listed only if the fit is not determined.
    Ragged<Index> strained_around, volumetric_around;

    /// Source of the value of a node: a row of `smooth`, or the rows `extrapolations` if `smooth` is no_index.
    struct Value {
        Index smooth;
        Range extrapolations;
        Vec3 rest;  // rest position [m]
    };
    std::vector<Value> values;  // in the order of `nodes`
};

RecoveryPlan plan_recovery(const RecoveryMesh& body, std::span<const Index> nodes);

}  // namespace skerry
