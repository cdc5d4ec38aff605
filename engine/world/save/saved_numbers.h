// Values of a world that are not stored in tables, with their names in a file.
#pragma once

#include <array>

#include "components/row_type.h"
#include "components/step_watch.h"
#include "engine/world/state/clock.h"
#include "engine/world/state/held_depth.h"
#include "engine/world/step/balance.h"
#include "engine/world/tuning.h"
#include "skerry/report.h"
#include "skerry/settings.h"

namespace skerry {

/// Members of StepWatch that are saved with this list. The columns `position`, `stiffness_sum` and `step` and the
/// member `evaluation` are saved separately. All other members are derived.
template <>
struct MembersOf<StepWatch> {
    static auto list() {
        using S = StepWatch;
        return std::array{Member{"steps", &S::steps}, Member{"second", &S::second}, Member{"body", &S::body},
                          Member{"kept", &S::kept}};
    }
};
template <>
struct MembersOf<StepEvaluation> {
    static auto list() {
        using S = StepEvaluation;
        return std::array{Member{"piece", &S::piece},       Member{"broken", &S::broken},
                          Member{"highest", &S::highest},   Member{"element", &S::element},
                          Member{"known", &S::known},       Member{"deformation", &S::deformation},
                          Member{"in_frame", &S::in_frame}, Member{"element_in_frame", &S::element_in_frame}};
    }
    static_assert(sizeof(StepEvaluation) == 16 * sizeof(Real),
                  "every member of this struct must be in the list of saved members");
};
template <>
struct MembersOf<Balance> {
    static auto list() {
        using S = Balance;
        return std::array{Member{"open", &S::open},
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
    static_assert(sizeof(Balance) == 17 * sizeof(Real),
                  "every member of this struct must be in the list of saved members");
};
template <>
struct MembersOf<HeldDepth> {
    static auto list() {
        using S = HeldDepth;
        return std::array{Member{"depth", &S::depth}, Member{"pair", &S::pair}};
    }
};
template <>
struct MembersOf<RunCounters> {
    static auto list() {
        using S = RunCounters;
        return std::array{Member{"steps", &S::steps},
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
                          Member{"plastic_work", &S::plastic_work},
                          Member{"max_penetration", &S::max_penetration},
                          Member{"max_gap_violation", &S::max_gap_violation},
                          Member{"start_penetration", &S::start_penetration},
                          Member{"start_gap_violation", &S::start_gap_violation}};
    }
    static_assert(sizeof(RunCounters) == 32 * sizeof(Real),
                  "every member of this struct must be in the list of saved members");
};
/// Members of Settings that are saved with this list. The member step_size is saved separately, because it may have no
/// value.
template <>
struct MembersOf<Settings> {
    static auto list() {
        using S = Settings;
        return std::array{Member{"gravity", &S::gravity},
                          Member{"integrator", &S::integrator},
                          Member{"clusters", &S::clusters},
                          Member{"backend", &S::backend},
                          Member{"threads", &S::threads},
                          Member{"contact_regions", &S::contact_regions},
                          Member{"method", &S::method},
                          Member{"friction", &S::friction},
                          Member{"tolerance", &S::tolerance},
                          Member{"max_iterations", &S::max_iterations},
                          Member{"recovery_speed", &S::recovery_speed},
                          Member{"theta", &S::theta},
                          Member{"implicit_step", &S::implicit_step},
                          Member{"start_overlaps", &S::start_overlaps},
                          Member{"sleep", &S::sleep},
                          Member{"sleep_time", &S::sleep_time},
                          Member{"continuous_collision", &S::continuous_collision}};
    }
    static_assert(sizeof(Settings) == 136, "every setting must be in the list of saved settings");
};
template <>
struct MembersOf<Tuning> {
    static auto list() {
        using S = Tuning;
        return std::array{Member{"step_safety", &S::step_safety},
                          Member{"max_strain_step", &S::max_strain_step},
                          Member{"restitution_speed", &S::restitution_speed},
                          Member{"sleep_speed", &S::sleep_speed},
                          Member{"contact_budgets", &S::contact_budgets},
                          Member{"warm_start", &S::warm_start},
                          Member{"fixed_iterations", &S::fixed_iterations},
                          Member{"relaxation", &S::relaxation},
                          Member{"certify_warm_start", &S::certify_warm_start},
                          Member{"skip_separating", &S::skip_separating},
                          Member{"frictionless_rows", &S::frictionless_rows},
                          Member{"small_regions_in_lanes", &S::small_regions_in_lanes}};
    }
    static_assert(sizeof(Tuning) == 64, "every setting must be in the list of saved settings");
};

}  // namespace skerry
