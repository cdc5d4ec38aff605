// Lists of the members of those table structs that contain numbers of several types. Saved worlds contain the member
// names, so the strings must not change.
#include <array>
#include <cstring>
#include <stdexcept>

#include "components/anchor.h"
#include "components/collider_table.h"
#include "components/contact_table.h"
#include "components/material_table.h"
#include "components/pair_table.h"

namespace skerry {

namespace {

template <class T>
T copy_of(const std::byte* address) {
    T number;
    std::memcpy(&number, address, sizeof number);
    return number;
}

}  // namespace

std::int64_t number_at(const std::byte* address, NumberType type) {
    switch (type) {
        case NumberType::int32:
            return copy_of<std::int32_t>(address);
        case NumberType::uint8:
            return copy_of<std::uint8_t>(address);
        case NumberType::uint16:
            return copy_of<std::uint16_t>(address);
        case NumberType::uint32:
            return copy_of<std::uint32_t>(address);
        case NumberType::uint64:
            return static_cast<std::int64_t>(copy_of<std::uint64_t>(address));
        case NumberType::real:
        case NumberType::single:
            break;
    }
    throw std::logic_error("number_at() was called for a column of reals, but reads integers only");
}

std::span<const Member> MembersOf<MaterialConstants>::list() {
    using S = MaterialConstants;
    static_assert(sizeof(MaterialConstants) == 50 * sizeof(Real),
                  "every member of this struct must be in the list of saved members");
    static const std::array list{Member{"model", &S::model},
                                 Member{"shear_modulus", &S::shear_modulus},
                                 Member{"lame_lambda", &S::lame_lambda},
                                 Member{"density", &S::density},
                                 Member{"loss_factor", &S::loss_factor},
                                 Member{"bulk_viscosity", &S::bulk_viscosity},
                                 Member{"share", &S::share},
                                 Member{"exponent", &S::exponent},
                                 Member{"strain_modes", &S::strain_modes},
                                 Member{"yield_stress", &S::yield_stress},
                                 Member{"hardening", &S::hardening}};
    return list;
}

std::span<const Member> MembersOf<ColliderGeometry>::list() {
    using S = ColliderGeometry;
    static const std::array list{Member{"shape", &S::shape}, Member{"size", &S::size}};
    return list;
}

std::span<const Member> MembersOf<MotionScript>::list() {
    using S = MotionScript;
    static_assert(sizeof(MotionScript) == 8 * sizeof(Real),
                  "every member of this struct must be in the list of saved members");
    static const std::array list{Member{"velocity", &S::velocity}, Member{"angular_velocity", &S::angular_velocity},
                                 Member{"key_begin", &S::key_begin}, Member{"key_end", &S::key_end},
                                 Member{"start", &S::start}};
    return list;
}

std::span<const Member> MembersOf<Stencil>::list() {
    using S = Stencil;
    static const std::array list{Member{"node", &S::node}, Member{"weight", &S::weight}};
    return list;
}

std::span<const Member> MembersOf<AnchorRow>::list() {
    using S = AnchorRow;
    static const std::array list{Member{"node", &S::node}, Member{"weight", &S::weight}, Member{"point", &S::point}};
    return list;
}

std::span<const Member> MembersOf<Candidate>::list() {
    using S = Candidate;
    static const std::array list{Member{"feature", &S::feature}, Member{"first", &S::first},
                                 Member{"second", &S::second}};
    return list;
}

std::span<const Member> MembersOf<LeafPair>::list() {
    using S = LeafPair;
    static const std::array list{Member{"first", &S::first}, Member{"second", &S::second}, Member{"spare", &S::spare}};
    return list;
}

}  // namespace skerry
