#include "systems/contact/keep_resting_contacts.h"

#include <algorithm>

#include "components/check.h"
#include "systems/contact/contact_columns.h"

namespace skerry {
namespace {

class RestingPairs {
public:
    explicit RestingPairs(const RestingInputs& inputs) : inputs_(inputs) {}

    bool any_body() const { return std::ranges::find(inputs_.asleep, 1) != inputs_.asleep.end(); }

    /// True if neither partner of a contact moves after this step.
    bool rests(const ContactTable& contacts, std::size_t c) const {
        return body_rests(contacts.first_body[c]) && body_rests(contacts.second_body[c]) &&
               stands_still(contacts.collider[c]);
    }

    /// Calls take(begin, end, idle) for the stored contacts of each pair of objects, which are rows begin .. end - 1 of
    /// `kept`. `idle`: true if this step did not search for contacts of the pair, because neither partner moves. Stored
    /// contacts and pairs are both in key order.
    void for_each_kept(const RestingContactTable& kept, auto&& take) const {
        const std::span<const ContactKey> key = kept.contact.key.span();
        std::size_t p = 0;
        for (std::size_t begin = 0; begin < key.size();) {
            const std::uint64_t pair = key[begin].pair;
            while (p < inputs_.pair.size() && inputs_.pair[p] < pair) ++p;
            const auto end = static_cast<std::size_t>(
                std::upper_bound(key.begin() + static_cast<std::ptrdiff_t>(begin), key.end(), pair,
                                 [](std::uint64_t pair_key, const ContactKey& row) { return pair_key < row.pair; }) -
                key.begin());
            take(begin, end, p < inputs_.pair.size() && inputs_.pair[p] == pair && inputs_.idle[p] != 0);
            begin = end;
        }
    }

private:
    bool stands_still(Index collider) const {
        return collider == no_index || inputs_.motion[static_cast<std::size_t>(collider)].stands_still();
    }
    bool body_rests(Index body) const {
        if (body == no_index) return true;
        const auto b = static_cast<std::size_t>(body);
        return inputs_.kind[b] == BodyKind::kinematic ? stands_still(inputs_.collider_of_body[b])
                                                      : inputs_.asleep[b] != 0;
    }

    const RestingInputs& inputs_;
};

/// Fills RestingMemory::source, which lists the rows to copy into the new table of stored contacts. An entry r >= 0 is
/// row r of `kept`, the contacts stored so far. An entry ~c (negative) is row c of `contacts`, the contacts of this
/// step.
void list_sources(const ContactTable& contacts, const RestingPairs& pairs, const RestingContactTable& kept,
                  Column<Index>& source) {
    source.clear();
    std::size_t c = 0;
    const auto take_new = [&](std::size_t end) {
        for (; c < end; ++c)
            if (pairs.rests(contacts, c)) source.push_back(~static_cast<Index>(c));
    };
    const std::span<const ContactKey> key = contacts.key.span();
    pairs.for_each_kept(kept, [&](std::size_t begin, std::size_t end, bool stays) {
        if (!stays) return;
        const ContactKey first{kept.contact.key[begin].pair, 0};
        take_new(static_cast<std::size_t>(
            std::lower_bound(key.begin() + static_cast<std::ptrdiff_t>(c), key.end(), first) - key.begin()));
        for (std::size_t row = begin; row < end; ++row) source.push_back(static_cast<Index>(row));
    });
    take_new(key.size());
}

}  // namespace

bool keep_resting_contacts(const ContactTable& contacts, const RestingInputs& inputs, Real kick, RestingMemory& memory,
                           RestingContactTable& kept) {
    SKERRY_CHECK(inputs.idle.size() == inputs.pair.size());
    const RestingPairs pairs(inputs);
    const bool any_rests = pairs.any_body();
    if (!any_rests && kept.empty()) return false;
    bool changes = false;
    for (std::size_t c = 0; any_rests && c < contacts.size() && !changes; ++c) changes = pairs.rests(contacts, c);
    if (!changes) pairs.for_each_kept(kept, [&](std::size_t, std::size_t, bool stays) { changes |= !stays; });
    if (!changes) return false;

    list_sources(contacts, pairs, kept, memory.source);
    const std::span<const Index> source = memory.source;
    const auto gather = [source](auto& to, auto&& kept_column, auto&& step_column) {
        to.resize(source.size());
        for (std::size_t row = 0; row < source.size(); ++row)
            to[row] = source[row] < 0 ? step_column(static_cast<std::size_t>(~source[row]))
                                      : kept_column(static_cast<std::size_t>(source[row]));
    };
    RestingContactTable& next = memory.next;
    for_each_column_of(next.contact, kept.contact, contacts, [&](auto& to, const auto& old, const auto& now) {
        gather(
            to, [&](std::size_t row) -> const auto& { return old[row]; },
            [&](std::size_t row) -> const auto& { return now[row]; });
    });
    std::ranges::fill(next.contact.region, no_index);
    gather(
        next.step, [&](std::size_t row) { return kept.step[row]; }, [kick](std::size_t) { return kick; });
    std::swap(kept, next);
    return true;
}

void merge_contacts(const ContactTable& contacts, const RestingContactTable& kept, Column<Index>& rows) {
    rows.clear();
    std::size_t row = 0;
    const auto take_resting = [&](auto&& is_before) {
        for (; row < kept.size() && is_before(kept.contact.key[row]); ++row) rows.push_back(~static_cast<Index>(row));
    };
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        take_resting([&](const ContactKey& key) { return key < contacts.key[c]; });
        if (row < kept.size() && kept.contact.key[row] == contacts.key[c]) ++row;
        rows.push_back(static_cast<Index>(c));
    }
    take_resting([](const ContactKey&) { return true; });
}

}  // namespace skerry
