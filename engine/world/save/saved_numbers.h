// Rows of columns as numbers of one type, as a file keeps them.
#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <tuple>
#include <type_traits>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/contact_table.h"
#include "components/element_table.h"
#include "components/joint_table.h"
#include "components/material_table.h"
#include "components/pair_table.h"
#include "components/step_watch.h"
#include "engine/world/state/clock.h"
#include "engine/world/step/balance.h"
#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

template <std::size_t bytes, bool is_signed>
struct IntegerOf;
template <>
struct IntegerOf<1, false> {
    using type = std::uint8_t;
};
template <>
struct IntegerOf<2, false> {
    using type = std::uint16_t;
};
template <>
struct IntegerOf<4, false> {
    using type = std::uint32_t;
};
template <>
struct IntegerOf<8, false> {
    using type = std::uint64_t;
};
template <>
struct IntegerOf<4, true> {
    using type = std::int32_t;
};

/// What a row consists of: `count` numbers of type `type` without gaps.
template <class T>
struct NumbersOf;
template <class T>
requires std::is_integral_v<T>
struct NumbersOf<T> {
    using type = typename IntegerOf<sizeof(T), std::is_signed_v<T>>::type;
    static constexpr std::size_t count = 1;
};
template <class Number, std::size_t n>
struct SameNumbers {
    using type = Number;
    static constexpr std::size_t count = n;
};
template <>
struct NumbersOf<bool> : SameNumbers<std::uint8_t, 1> {};
template <>
struct NumbersOf<Real> : SameNumbers<Real, 1> {};
template <class E>
requires std::is_enum_v<E>
struct NumbersOf<E> : NumbersOf<std::underlying_type_t<E>> {
};
template <int rows, int columns>
struct NumbersOf<Eigen::Matrix<Real, rows, columns>> : SameNumbers<Real, std::size_t{rows * columns}> {};
template <class T, std::size_t n>
struct NumbersOf<std::array<T, n>> : SameNumbers<typename NumbersOf<T>::type, n * NumbersOf<T>::count> {};
template <class T, int n>
struct NumbersOf<Lanes<T, n>> : SameNumbers<typename NumbersOf<T>::type, std::size_t{n} * NumbersOf<T>::count> {};
template <>
struct NumbersOf<Range> : SameNumbers<Index, 2> {};
template <>
struct NumbersOf<ContactKey> : SameNumbers<std::uint64_t, 2> {};
template <>
struct NumbersOf<RigidMotion> : SameNumbers<Real, 18> {};
template <>
struct NumbersOf<MovingFrame> : SameNumbers<Real, 10> {};
template <>
struct NumbersOf<Keyframe> : SameNumbers<Real, 7> {};
template <>
struct NumbersOf<CollisionFilter> : SameNumbers<std::uint32_t, 2> {};
template <>
struct NumbersOf<JointFrame> : SameNumbers<Real, 12> {};
template <>
struct NumbersOf<JointMotorRow> : SameNumbers<Real, 3> {};
template <>
struct NumbersOf<SurfaceProperties> : SameNumbers<Real, 3> {};

/// How many values an enum has: others are refused. 0: no enum.
template <class T>
inline constexpr std::uint64_t value_count = 0;
template <class E>
requires requires {
    EnumNames<E>::table;
}
inline constexpr std::uint64_t value_count<E> = EnumNames<E>::table.size();
template <>
inline constexpr std::uint64_t value_count<bool> = 2;
template <>
inline constexpr std::uint64_t value_count<BodyKind> = 2;
template <>
inline constexpr std::uint64_t value_count<ElementPart> = 4;
template <>
inline constexpr std::uint64_t value_count<ColliderShape> = 7;
template <>
inline constexpr std::uint64_t value_count<PairKind> = 3;
template <>
inline constexpr std::uint64_t value_count<PairState> = 3;
template <>
inline constexpr std::uint64_t value_count<ContactKind> = 5;
template <>
inline constexpr std::uint64_t value_count<ContactState> = 3;
template <>
inline constexpr std::uint64_t value_count<JointDrive> = 3;

template <class S, class T>
struct Member {
    const char* name;
    T S::*place;
};
template <class S, class T>
Member(const char*, T S::*) -> Member<S, T>;

/// The members of what has more than one kind of number: each is saved as a column of its own.
template <class S>
struct MembersOf;

template <class S>
concept HasMembers = requires {
    MembersOf<S>::list();
};
template <class T>
concept Savable = HasMembers<T> || requires {
    NumbersOf<T>::count;
};

template <>
struct MembersOf<MaterialConstants> {
    static constexpr auto list() {
        using S = MaterialConstants;
        return std::tuple{Member{"model", &S::model},
                          Member{"shear_modulus", &S::shear_modulus},
                          Member{"lame_lambda", &S::lame_lambda},
                          Member{"density", &S::density},
                          Member{"loss_factor", &S::loss_factor},
                          Member{"bulk_viscosity", &S::bulk_viscosity}};
    }
    static_assert(sizeof(MaterialConstants) == 6 * sizeof(Real), "a member is not saved");
};
template <>
struct MembersOf<ColliderGeometry> {
    static constexpr auto list() {
        return std::tuple{Member{"shape", &ColliderGeometry::shape}, Member{"size", &ColliderGeometry::size}};
    }
};
template <>
struct MembersOf<MotionScript> {
    static constexpr auto list() {
        using S = MotionScript;
        return std::tuple{Member{"velocity", &S::velocity}, Member{"angular_velocity", &S::angular_velocity},
                          Member{"key_begin", &S::key_begin}, Member{"key_end", &S::key_end},
                          Member{"start", &S::start}};
    }
    static_assert(sizeof(MotionScript) == 8 * sizeof(Real), "a member is not saved");
};
template <>
struct MembersOf<Stencil> {
    static constexpr auto list() {
        return std::tuple{Member{"node", &Stencil::node}, Member{"weight", &Stencil::weight}};
    }
};
template <>
struct MembersOf<Candidate> {
    static constexpr auto list() {
        using S = Candidate;
        return std::tuple{Member{"feature", &S::feature}, Member{"first", &S::first}, Member{"second", &S::second}};
    }
};
/// All but its columns and the look, and what is found anew before each step.
template <>
struct MembersOf<StepWatch> {
    static constexpr auto list() {
        using S = StepWatch;
        return std::tuple{Member{"steps", &S::steps}, Member{"second", &S::second}, Member{"body", &S::body},
                          Member{"kept", &S::kept}};
    }
};
template <>
struct MembersOf<StepLook> {
    static constexpr auto list() {
        using S = StepLook;
        return std::tuple{Member{"piece", &S::piece},       Member{"broken", &S::broken},
                          Member{"highest", &S::highest},   Member{"element", &S::element},
                          Member{"known", &S::known},       Member{"deformation", &S::deformation},
                          Member{"in_frame", &S::in_frame}, Member{"element_in_frame", &S::element_in_frame}};
    }
    static_assert(sizeof(StepLook) == 16 * sizeof(Real), "a member is not saved");
};
template <>
struct MembersOf<Balance> {
    static constexpr auto list() {
        using S = Balance;
        return std::tuple{Member{"open", &S::open},
                          Member{"momentum_known", &S::momentum_known},
                          Member{"steps", &S::steps},
                          Member{"energy", &S::energy},
                          Member{"potential", &S::potential},
                          Member{"momentum", &S::momentum},
                          Member{"impulse", &S::impulse},
                          Member{"work", &S::work},
                          Member{"energy_flow", &S::energy_flow},
                          Member{"momentum_flow", &S::momentum_flow},
                          Member{"energy_error", &S::energy_error},
                          Member{"energy_scale", &S::energy_scale},
                          Member{"momentum_error", &S::momentum_error},
                          Member{"momentum_scale", &S::momentum_scale}};
    }
    static_assert(sizeof(Balance) == 17 * sizeof(Real), "a member is not saved");
};
template <>
struct MembersOf<RunCounters> {
    static constexpr auto list() {
        using S = RunCounters;
        return std::tuple{Member{"steps", &S::steps},
                          Member{"inline_steps", &S::inline_steps},
                          Member{"resting_steps", &S::resting_steps},
                          Member{"unstrained", &S::unstrained},
                          Member{"shortened", &S::shortened},
                          Member{"retried", &S::retried},
                          Member{"limited", &S::limited},
                          Member{"inversions", &S::inversions},
                          Member{"contact_sum", &S::contact_sum},
                          Member{"iteration_sum", &S::iteration_sum},
                          Member{"solved", &S::solved},
                          Member{"unconverged", &S::unconverged},
                          Member{"certified", &S::certified},
                          Member{"closed_form", &S::closed_form},
                          Member{"separating", &S::separating},
                          Member{"frictionless", &S::frictionless},
                          Member{"in_lanes", &S::in_lanes},
                          Member{"frozen", &S::frozen},
                          Member{"contact_steps", &S::contact_steps},
                          Member{"swept", &S::swept},
                          Member{"large_strain_steps", &S::large_strain_steps},
                          Member{"newton_steps", &S::newton_steps},
                          Member{"tangent_factors", &S::tangent_factors},
                          Member{"max_contacts", &S::max_contacts},
                          Member{"max_regions", &S::max_regions},
                          Member{"largest_region", &S::largest_region},
                          Member{"worst_error", &S::worst_error},
                          Member{"worst_region", &S::worst_region},
                          Member{"dissipated", &S::dissipated},
                          Member{"max_penetration", &S::max_penetration},
                          Member{"max_gap_violation", &S::max_gap_violation},
                          Member{"start_penetration", &S::start_penetration},
                          Member{"start_gap_violation", &S::start_gap_violation}};
    }
    static_assert(sizeof(RunCounters) == 32 * sizeof(Real), "a member is not saved");
};
/// All but step_size, which may be none.
template <>
struct MembersOf<Settings> {
    static constexpr auto list() {
        using S = Settings;
        return std::tuple{Member{"gravity", &S::gravity},
                          Member{"step_safety", &S::step_safety},
                          Member{"integrator", &S::integrator},
                          Member{"clusters", &S::clusters},
                          Member{"backend", &S::backend},
                          Member{"threads", &S::threads},
                          Member{"contact_regions", &S::contact_regions},
                          Member{"method", &S::method},
                          Member{"friction", &S::friction},
                          Member{"warm_start", &S::warm_start},
                          Member{"tolerance", &S::tolerance},
                          Member{"max_iterations", &S::max_iterations},
                          Member{"fixed_iterations", &S::fixed_iterations},
                          Member{"relaxation", &S::relaxation},
                          Member{"restitution_speed", &S::restitution_speed},
                          Member{"recovery_speed", &S::recovery_speed},
                          Member{"max_strain_step", &S::max_strain_step},
                          Member{"theta", &S::theta},
                          Member{"implicit_step", &S::implicit_step},
                          Member{"start_overlaps", &S::start_overlaps},
                          Member{"sleep", &S::sleep},
                          Member{"sleep_speed", &S::sleep_speed},
                          Member{"sleep_time", &S::sleep_time},
                          Member{"contact_budgets", &S::contact_budgets},
                          Member{"continuous_collision", &S::continuous_collision},
                          Member{"certify_warm_start", &S::certify_warm_start},
                          Member{"skip_separating", &S::skip_separating},
                          Member{"frictionless_rows", &S::frictionless_rows},
                          Member{"freeze_contacts", &S::freeze_contacts},
                          Member{"small_regions_in_lanes", &S::small_regions_in_lanes}};
    }
    static_assert(sizeof(Settings) == 184, "a setting is not saved");
};

/// The type of HDF5 that numbers have in memory and in files.
template <class Number>
hid_t hdf5_type() {
    if constexpr (std::is_same_v<Number, Real>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<Number, std::int32_t>) return H5T_NATIVE_INT32;
    if constexpr (std::is_same_v<Number, std::uint8_t>) return H5T_NATIVE_UINT8;
    if constexpr (std::is_same_v<Number, std::uint16_t>) return H5T_NATIVE_UINT16;
    if constexpr (std::is_same_v<Number, std::uint32_t>) return H5T_NATIVE_UINT32;
    if constexpr (std::is_same_v<Number, std::uint64_t>) return H5T_NATIVE_UINT64;
}

}  // namespace skerry
