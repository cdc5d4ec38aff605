// Approximation of a shape by nodes, edges and triangles, used to test the motion of the shape within a step.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "components/collider_table.h"
#include "systems/collision/colliders/time_of_touch.h"

namespace skerry {

/// A node, edge or triangle of a shape, in the frame of the shape.
struct Facet {
    TouchingFeature::Kind kind;
    std::array<Vec3, 3> at;  // positions of the nodes; 1, 2 or 3 are used, depending on `kind` [m]
    Real radius = 0;         // radius of the round surface around a node or an edge [m]
};

/// Facets of a sphere, capsule, box or cylinder, or of one part of a bucket, in a fixed order. Curved sides are
/// approximated by flat ones that do not protrude from the solid, so that no contact is found before the shape touches.
class ShapeFacets {
public:
    static constexpr int around = 32;

    ShapeFacets(const ColliderGeometry& geometry, Index part) : geometry_(geometry), part_(part) {}

    void for_each(auto&& visit) const {
        const Vec3& size = geometry_.size;
        switch (geometry_.shape) {
            case ColliderShape::sphere:
                visit(Facet{Kind::node, {Vec3::Zero()}, size[0]});
                return;
            case ColliderShape::capsule:
                visit(Facet{Kind::edge, {Vec3(0, 0, -size[1]), Vec3(0, 0, size[1])}, size[0]});
                return;
            case ColliderShape::box:
                of_box(visit);
                return;
            case ColliderShape::cylinder:
                of_rings({Ring{0, -size[1]}, {size[0], -size[1]}, {size[0], size[1]}, {0, size[1]}}, false, visit);
                return;
            case ColliderShape::bucket: {
                const Real outer = size[0] + size[2];
                if (part_ == 0)
                    of_rings({Ring{0, -size[2]}, {outer, -size[2]}, {outer, 0}, {0, 0}}, false, visit);
                else
                    of_rings({Ring{size[0], -size[2]}, {outer, -size[2]}, {outer, size[1]}, {size[0], size[1]}}, true,
                             visit);
                return;
            }
            case ColliderShape::plane:
            case ColliderShape::mesh:
                break;
        }
    }

private:
    using Kind = TouchingFeature::Kind;
    struct Ring {
        Real radius, z;  // [m]
    };

    static Real widening() {
        static const Real factor = 1 / std::cos(std::numbers::pi / around);
        return factor;
    }
    static void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, auto&& visit) {
        visit(Facet{Kind::face, {a, b, c}});
        visit(Facet{Kind::face, {a, c, d}});
    }
    void of_box(auto&& visit) const {
        const auto corner = [&](int k) {
            return Vec3(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).cwiseProduct(geometry_.size));
        };
        for (int k = 0; k < 8; ++k) visit(Facet{Kind::node, {corner(k)}});
        for (int k = 0; k < 8; ++k)
            for (int bit = 1; bit < 8; bit *= 2)
                if (!(k & bit)) visit(Facet{Kind::edge, {corner(k), corner(k | bit)}});
        // one bit per axis; b and c: bits of the other two axes, in cyclic order
        for (int bit = 1; bit < 8; bit *= 2) {
            const int b = bit == 4 ? 1 : 2 * bit, c = b == 4 ? 1 : 2 * b;
            quad(corner(bit), corner(bit | b), corner(bit | b | c), corner(bit | c), visit);
            quad(corner(0), corner(c), corner(b | c), corner(b), visit);
        }
    }
    /// Visits the nodes and edges on four rings around the z axis, and the edges and triangles between adjacent rings.
    /// In the half plane with the coordinates (radius, z), the rings are corners of a polygon, counter-clockwise.
    /// `closed`: true if the last ring is also connected with the first one.
    static void of_rings(const std::array<Ring, 4>& ring, bool closed, auto&& visit) {
        const auto at = [&](std::size_t i, int k) {
            const Real turn = 2 * std::numbers::pi * (k % around) / around;
            const bool hollow = closed && (i % 4 == 0 || i % 4 == 3);
            const Real radius = ring[i % 4].radius * (hollow ? widening() : 1);
            return Vec3(radius * std::cos(turn), radius * std::sin(turn), ring[i % 4].z);
        };
        for (std::size_t i = 0; i < 4; ++i)
            for (int k = 0; k < around && ring[i].radius > 0; ++k) {
                visit(Facet{Kind::node, {at(i, k)}});
                visit(Facet{Kind::edge, {at(i, k), at(i, k + 1)}});
            }
        for (std::size_t i = 0; i < (closed ? 4u : 3u); ++i)
            for (int k = 0; k < around; ++k) {
                if (ring[i].radius > 0 && ring[(i + 1) % 4].radius > 0)
                    visit(Facet{Kind::edge, {at(i, k), at(i + 1, k)}});
                if (ring[i].radius > 0) visit(Facet{Kind::face, {at(i, k), at(i, k + 1), at(i + 1, k + 1)}});
                if (ring[(i + 1) % 4].radius > 0) visit(Facet{Kind::face, {at(i, k), at(i + 1, k + 1), at(i + 1, k)}});
            }
    }

    const ColliderGeometry& geometry_;
    const Index part_;
};

}  // namespace skerry
