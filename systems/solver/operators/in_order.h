// Traversals of the contacts of a region. A traversal is a type that defines the visiting order of the contacts, the
// number of threads, and the effect of an impulse on the velocities. Shared code is written once and compiled for each
// traversal.
#pragma once

#include <concepts>
#include <cstddef>
#include <utility>

#include "components/types.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// A visiting order. It calls `body` with ranges [begin, end) that together cover the indices [0, count) of the order.
/// Contacts that share a node are never visited concurrently, and always in the same order.
template <class W>
concept RegionOrder = requires(const W traversal, std::size_t count, void (*body)(std::size_t, std::size_t),
                               Real (*part)(std::size_t, std::size_t)) {
    // number in the region of the contact with this index in the visiting order
    { traversal.number_of(count) } -> std::convertible_to<std::size_t>;
    traversal.contacts(count, body);
    traversal.nodes(count, body);
    {
        traversal.template sum<Real>(count, part)
        } -> std::same_as<Real>;  // sum over the contacts, always in the same order
};

/// A visiting order together with the effect of impulses on nodes.
template <class W>
concept RegionTraversal = RegionOrder<W> &&
    requires(const W traversal, const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) {
    // true if every moving node has its own mass and belongs to no cluster
    { W::own_masses } -> std::convertible_to<bool>;
    traversal.apply(contact, impulse, velocity);  // velocities of the region's nodes += M^-1 J^T impulse
    { traversal.coupling(contact, contact) } -> std::same_as<Real>;  // scalar block J M^-1 J^T of two contacts [1/kg]
};

/// Visiting order with one thread: ascending contact numbers.
struct OneThread {
    std::size_t number_of(std::size_t position) const { return position; }
    template <class Body>
    void contacts(std::size_t count, Body&& body) const {
        body(std::size_t{0}, count);
    }
    template <class Body>
    void nodes(std::size_t count, Body&& body) const {
        body(std::size_t{0}, count);
    }
    template <class Sum, class Part>
    Sum sum(std::size_t count, Part&& part) const {
        return part(std::size_t{0}, count);
    }
};

static_assert(RegionOrder<OneThread>);

/// Traversal by one thread in ascending order, for regions in which every node has its own mass.
struct InOrder : OneThread {
    static constexpr bool own_masses = true;

    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        apply_impulse(contact, impulse, velocity);
    }
    Real coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b); }
};

static_assert(RegionTraversal<InOrder>);

}  // namespace skerry
