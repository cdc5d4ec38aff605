// Walks: in which order, and by how many threads, the contacts of a region are passed over. A walk is a type, so that
// what is written once for all of them is compiled for each as if it had been written for it alone.
#pragma once

#include <concepts>
#include <cstddef>
#include <utility>

#include "components/types.h"

namespace skerry {

/// Bodies are called with ranges [begin, end) of places that make up all of them. Contacts that share a node are never
/// passed over at the same time, and always in the same order.
template <class W>
concept RegionWalk = requires(const W walk, std::size_t count, void (*body)(std::size_t, std::size_t),
                              Real (*part)(std::size_t, std::size_t)) {
    { W::one_thread } -> std::convertible_to<bool>;
    { walk.number_of(count) } -> std::convertible_to<std::size_t>;  // of the contact at a place, within its region
    walk.contacts(count, body);
    walk.nodes(count, body);
    { walk.template sum<Real>(count, part) } -> std::same_as<Real>;  // over the contacts, always in the same order
};

/// One thread, in the order of the contacts.
struct InOrder {
    static constexpr bool one_thread = true;

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
};

static_assert(RegionWalk<InOrder>);

}  // namespace skerry
