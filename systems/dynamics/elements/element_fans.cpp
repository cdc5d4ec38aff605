#include "systems/dynamics/elements/element_fans.h"

#include <algorithm>

#include "components/check.h"
#include "components/counting_sort.h"
#include "components/element_table.h"

namespace skerry {

namespace {

/// Longer ones save next to nothing more, and are rare: an edge has five tetrahedra around it.
constexpr std::size_t longest_fan = 6;

/// An element beside one of its edges.
struct AroundEdge {
    Index a, b;          // the edge, a < b, by places among the nodes of the group
    Index element;       // place among those that are sorted
    NodeOrder order;     // a, b, then the other two
    std::uint8_t taken;  // 1: on the way that is being looked for
};

using Fan = std::vector<AroundEdge>;

/// Elements around the edges of a group, and which of them no fan has taken.
class FanSearch {
public:
    FanSearch(const ElementList& list, std::span<const Index> elements)
        : list_(list), elements_(elements), free_(elements.size(), 1) {
        for (const Index e : elements)
            for (std::size_t k = 0; k < 4; ++k)
                nodes_.push_back(list.node[list.first_node[static_cast<std::size_t>(e)] + k]);
        std::ranges::sort(nodes_);
        nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
        around_.reserve(6 * elements.size());
        for (std::size_t e = 0; e < elements.size(); ++e) {
            const std::array<Index, 4> place = places_of_corners(elements[e]);
            for (std::uint8_t i = 0; i < 4; ++i)
                for (std::uint8_t j = i + 1; j < 4; ++j) add_edge(static_cast<Index>(e), place, i, j);
        }
        const auto count = static_cast<Index>(nodes_.size());
        counting_sort(around_, count, [](const AroundEdge& at) { return at.b; });
        counting_sort(around_, count, [](const AroundEdge& at) { return at.a; });
    }

    /// Takes fans of `length` for as long as some edge has one.
    void take(std::size_t length, std::vector<Fan>& fans) {
        for (std::size_t first = 0; first < around_.size();) {
            std::size_t end = first + 1;
            while (end < around_.size() && around_[end].a == around_[first].a && around_[end].b == around_[first].b)
                ++end;
            if (end - first >= length)
                while (walk(std::span(around_).subspan(first, end - first), length)) {
                    fans.push_back(way_);
                    for (const AroundEdge& at : way_) free_[static_cast<std::size_t>(at.element)] = 0;
                }
            first = end;
        }
    }

    /// The last element of a fan.
    void give_back(Fan& fan) {
        free_[static_cast<std::size_t>(fan.back().element)] = 1;
        fan.pop_back();
    }

    bool is_free(std::size_t element) const { return free_[element] != 0; }

private:
    Index node(const AroundEdge& at, std::size_t k) const {
        const auto element = static_cast<std::size_t>(elements_[static_cast<std::size_t>(at.element)]);
        return list_.node[list_.first_node[element] + at.order[k]];
    }

    std::array<Index, 4> places_of_corners(Index element) const {
        std::array<Index, 4> place;
        for (std::size_t k = 0; k < 4; ++k) {
            const Index node = list_.node[list_.first_node[static_cast<std::size_t>(element)] + k];
            place[k] = static_cast<Index>(std::ranges::lower_bound(nodes_, node) - nodes_.begin());
        }
        return place;
    }

    void add_edge(Index element, const std::array<Index, 4>& place, std::uint8_t i, std::uint8_t j) {
        AroundEdge at{0, 0, element, {i, j, 0, 0}, 0};
        std::size_t others = 2;
        for (std::uint8_t k = 0; k < 4; ++k)
            if (k != i && k != j) at.order[others++] = k;
        if (place[i] > place[j]) std::swap(at.order[0], at.order[1]);
        at.a = std::min(place[i], place[j]);
        at.b = std::max(place[i], place[j]);
        around_.push_back(at);
    }

    bool usable(const AroundEdge& at) const {
        return free_[static_cast<std::size_t>(at.element)] != 0 && at.taken == 0;
    }

    /// Finds `length` free elements around an edge, each beside the one before: from the first of them that is at an
    /// end if there is one, else from any.
    bool walk(std::span<AroundEdge> edge, std::size_t length) {
        for (const bool from_ends : {true, false})
            for (AroundEdge& start : edge) {
                if (!usable(start) || (from_ends && !turn_from_end(edge, start))) continue;
                for (AroundEdge& at : edge) at.taken = 0;
                way_.clear();
                for (AroundEdge* at = &start; at != nullptr && way_.size() < length;) {
                    at->taken = 1;
                    way_.push_back(*at);
                    at = next_to(edge, node(*at, 3));
                }
                for (AroundEdge& at : edge) at.taken = 0;
                if (way_.size() == length) return true;
            }
        return false;
    }

    /// Whether no other free element has one of the two nodes beside the edge; that one comes first then.
    bool turn_from_end(std::span<AroundEdge> edge, AroundEdge& start) const {
        const auto has_neighbour = [&](Index n) {
            return std::ranges::any_of(edge, [&](const AroundEdge& at) {
                return at.element != start.element && usable(at) && (node(at, 2) == n || node(at, 3) == n);
            });
        };
        if (!has_neighbour(node(start, 2))) return true;
        if (has_neighbour(node(start, 3))) return false;
        std::swap(start.order[2], start.order[3]);
        return true;
    }

    AroundEdge* next_to(std::span<AroundEdge> edge, Index shared) const {
        for (AroundEdge& at : edge) {
            if (!usable(at) || (node(at, 2) != shared && node(at, 3) != shared)) continue;
            if (node(at, 2) != shared) std::swap(at.order[2], at.order[3]);
            return &at;
        }
        return nullptr;
    }

    const ElementList& list_;
    std::span<const Index> elements_;
    std::vector<std::uint8_t> free_;
    std::vector<Index> nodes_;        // of the group, ascending
    std::vector<AroundEdge> around_;  // edge after edge
    Fan way_;
};

}  // namespace

void sort_into_fans(const ElementList& list, std::span<Index> elements, std::vector<NodeOrder>& order) {
    FanSearch search(list, elements);
    std::vector<Fan> fans;
    std::vector<Index> sorted;
    sorted.reserve(elements.size());
    for (std::size_t length = longest_fan; length >= 2; --length) {
        search.take(length, fans);
        const std::size_t whole = fans.size() / element_lanes * element_lanes;
        for (std::size_t first = 0; first < whole; first += element_lanes)
            for (std::size_t i = 0; i < length; ++i)
                for (std::size_t l = 0; l < element_lanes; ++l) {
                    const AroundEdge& at = fans[first + l][i];
                    sorted.push_back(elements[static_cast<std::size_t>(at.element)]);
                    order[static_cast<std::size_t>(sorted.back())] = at.order;
                }
        // Fewer than eight: one shorter they may go with others.
        fans.erase(fans.begin(), fans.begin() + static_cast<std::ptrdiff_t>(whole));
        for (Fan& fan : fans) search.give_back(fan);
    }
    for (Fan& fan : fans) search.give_back(fan);
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (search.is_free(e)) sorted.push_back(elements[e]);
    SKERRY_CHECK(sorted.size() == elements.size());
    std::ranges::copy(sorted, elements.begin());
}

}  // namespace skerry
