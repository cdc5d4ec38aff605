// Walks: in which order, and by how many threads, the contacts of a region are passed over, and what an impulse moves.
// A walk is a type, so that what is written once for all of them is compiled for each as if it had been written for it
// alone.
#pragma once

#include <concepts>
#include <cstddef>
#include <utility>

#include "components/types.h"
#include "systems/solver/local/lumped_contact.h"

namespace skerry {

/// Bodies are called with ranges [begin, end) of places that make up all of them. Contacts that share a node are never
/// passed over at the same time, and always in the same order.
template <class W>
concept RegionWalk = requires(const W walk, std::size_t count, void (*body)(std::size_t, std::size_t),
                              Real (*part)(std::size_t, std::size_t), const LumpedContact& contact, const Vec4& impulse,
                              Vec4* velocity) {
    { W::one_thread } -> std::convertible_to<bool>;
    { W::own_masses } -> std::convertible_to<bool>;  // J M^-1 J^T of a contact alone is its LumpedContact::diagonal
    { walk.number_of(count) } -> std::convertible_to<std::size_t>;  // of the contact at a place, within its region
    walk.contacts(count, body);
    walk.nodes(count, body);
    { walk.template sum<Real>(count, part) } -> std::same_as<Real>;  // over the contacts, always in the same order
    walk.apply(contact, impulse, velocity);                          // velocities of the region's nodes += M^-1 J^T r
    { walk.coupling(contact, contact) } -> std::same_as<Real>;       // 1/kg, J M^-1 J^T of two contacts
};

/// One thread, in the order of the contacts; every node by its own mass.
struct InOrder {
    static constexpr bool one_thread = true;
    static constexpr bool own_masses = true;

    std::size_t number_of(std::size_t place) const { return place; }
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
    void apply(const LumpedContact& contact, const Vec4& impulse, Vec4* velocity) const {
        apply_impulse(contact, impulse, velocity);
    }
    Real coupling(const LumpedContact& a, const LumpedContact& b) const { return coupling_of(a, b); }
};

static_assert(RegionWalk<InOrder>);

}  // namespace skerry
