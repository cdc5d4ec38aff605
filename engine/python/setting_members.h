// The members of each struct of settings, by the names that Python and scene files use. for_each_setting(settings,
// visit) calls visit(name, member) for each of them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/problem.h"
#include "skerry/settings.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "skerry/world.h"

namespace skerry::python {

template <class Struct, class Expected>
concept Is = std::is_same_v<std::remove_const_t<Struct>, Expected>;

void for_each_setting(Is<Settings> auto& s, auto&& visit) {
    visit("gravity", s.gravity);
    visit("step_size", s.step_size);
    visit("theta", s.theta);
    visit("implicit_step", s.implicit_step);
    visit("integrator", s.integrator);
    visit("clusters", s.clusters);
    visit("backend", s.backend);
    visit("threads", s.threads);
    visit("contact_regions", s.contact_regions);
    visit("method", s.method);
    visit("friction", s.friction);
    visit("tolerance", s.tolerance);
    visit("max_iterations", s.max_iterations);
    visit("recovery_speed", s.recovery_speed);
    visit("start_overlaps", s.start_overlaps);
    visit("sleep", s.sleep);
    visit("sleep_time", s.sleep_time);
    visit("continuous_collision", s.continuous_collision);
}

void for_each_setting(Is<MaterialSettings> auto& s, auto&& visit) {
    visit("young_modulus", s.young_modulus);
    visit("poisson_ratio", s.poisson_ratio);
    visit("density", s.density);
    visit("friction", s.friction);
    visit("static_friction", s.static_friction);
    visit("dynamic_friction", s.dynamic_friction);
    visit("restitution", s.restitution);
    visit("damping", s.damping);
    visit("loss_factor", s.loss_factor);
    visit("bulk_viscosity", s.bulk_viscosity);
    visit("model", s.model);
    visit("terms", s.terms);
    visit("orthotropic", s.orthotropic);
    visit("plasticity", s.plasticity);
}

void for_each_setting(Is<OrthotropicModuli> auto& s, auto&& visit) {
    visit("young_modulus", s.young_modulus);
    visit("poisson_ratio", s.poisson_ratio);
    visit("shear_modulus", s.shear_modulus);
    visit("first_axis", s.first_axis);
    visit("second_axis", s.second_axis);
}

void for_each_setting(Is<Plasticity> auto& s, auto&& visit) {
    visit("yield_stress", s.yield_stress);
    visit("hardening", s.hardening);
}

void for_each_setting(Is<BodySettings> auto& s, auto&& visit) {
    visit("position", s.position);
    visit("rotation", s.rotation);
    visit("velocity", s.velocity);
    visit("angular_velocity", s.angular_velocity);
    visit("contact_distance", s.contact_distance);
    visit("self_contact", s.self_contact);
    visit("dynamics", s.dynamics);
    visit("mass", s.mass);
    visit("center_of_mass", s.center_of_mass);
    visit("inertia", s.inertia);
    visit("collision_group", s.collision_group);
    visit("collision_mask", s.collision_mask);
    visit("element", s.element);
    visit("name", s.name);
}

void for_each_setting(Is<ColliderSettings> auto& s, auto&& visit) {
    visit("position", s.position);
    visit("rotation", s.rotation);
    visit("motion", s.motion);
    visit("friction", s.friction);
    visit("static_friction", s.static_friction);
    visit("dynamic_friction", s.dynamic_friction);
    visit("restitution", s.restitution);
    visit("contact_distance", s.contact_distance);
    visit("collision_group", s.collision_group);
    visit("collision_mask", s.collision_mask);
    visit("name", s.name);
}

void for_each_setting(Is<LoadSettings> auto& s, auto&& visit) {
    visit("backend", s.backend);
    visit("threads", s.threads);
}

void for_each_setting(Is<SurfaceSettings> auto& s, auto&& visit) {
    visit("friction", s.friction);
    visit("static_friction", s.static_friction);
    visit("dynamic_friction", s.dynamic_friction);
    visit("restitution", s.restitution);
}

void for_each_setting(Is<Pose> auto& s, auto&& visit) {
    visit("position", s.position);
    visit("rotation", s.rotation);
}

void for_each_setting(Is<MotionKey> auto& s, auto&& visit) {
    visit("time", s.time);
    visit("position", s.position);
    visit("rotation", s.rotation);
}

void for_each_setting(Is<Motion> auto& s, auto&& visit) {
    visit("velocity", s.velocity);
    visit("angular_velocity", s.angular_velocity);
    visit("keys", s.keys);
}

void for_each_setting(Is<JointSettings> auto& s, auto&& visit) {
    visit("kind", s.kind);
    visit("point", s.point);
    visit("axis", s.axis);
    visit("coordinate", s.coordinate);
    visit("lower", s.lower);
    visit("upper", s.upper);
    visit("motor", s.motor);
    visit("passive", s.passive);
    visit("bodies_touch", s.bodies_touch);
}

void for_each_setting(Is<JointPassive> auto& s, auto&& visit) {
    visit("stiffness", s.stiffness);
    visit("rest", s.rest);
    visit("damping", s.damping);
    visit("friction", s.friction);
}

void for_each_setting(Is<SpringSettings> auto& s, auto&& visit) {
    visit("stiffness", s.stiffness);
    visit("damping", s.damping);
    visit("rest_length", s.rest_length);
    visit("only", s.only);
    visit("strength", s.strength);
}

void for_each_setting(Is<MotorKey> auto& s, auto&& visit) {
    visit("time", s.time);
    visit("speed", s.speed);
    visit("position", s.position);
}

void for_each_setting(Is<JointMotor> auto& s, auto&& visit) {
    visit("speed", s.speed);
    visit("position", s.position);
    visit("strength", s.strength);
    visit("fastest", s.fastest);
    visit("keys", s.keys);
}

void for_each_setting(Is<TieSettings> auto& s, auto&& visit) {
    visit("kind", s.kind);
    visit("break_force", s.break_force);
    visit("close_gap", s.close_gap);
    visit("bodies_touch", s.bodies_touch);
}

void for_each_setting(Is<GasFilling> auto& s, auto&& visit) {
    visit("pressure", s.pressure);
    visit("exponent", s.exponent);
    visit("ambient", s.ambient);
    visit("density", s.density);
    visit("inflow", s.inflow);
}

void for_each_setting(Is<LiquidFilling> auto& s, auto&& visit) {
    visit("bulk_modulus", s.bulk_modulus);
    visit("volume", s.volume);
    visit("ambient", s.ambient);
}

void for_each_setting(Is<CableSettings> auto& s, auto&& visit) {
    visit("tension", s.drive.tension);
    visit("length", s.drive.length);
    visit("rate", s.drive.rate);
    visit("friction", s.friction);
}

void for_each_setting(Is<PipeSettings> auto& s, auto&& visit) {
    visit("conductance", s.conductance);
    visit("pressure", s.pressure);
}

void for_each_setting(Is<ForceLoad> auto& s, auto&& visit) {
    visit("force", s.force);
    visit("scale", s.scale);
}
void for_each_setting(Is<TractionLoad> auto& s, auto&& visit) {
    visit("faces", s.faces);
    visit("traction", s.traction);
    visit("scale", s.scale);
}
void for_each_setting(Is<AccelerationField> auto& s, auto&& visit) {
    visit("acceleration", s.acceleration);
    visit("scale", s.scale);
}
void for_each_setting(Is<GravityScale> auto& s, auto&& visit) {
    visit("scale", s.scale);
}
void for_each_setting(Is<DragField> auto& s, auto&& visit) {
    visit("rate", s.rate);
    visit("wind", s.wind);
    visit("scale", s.scale);
}

void for_each_setting(Is<ProblemSettings> auto& s, auto&& visit) {
    visit("method", s.method);
    visit("friction", s.friction);
    visit("tolerance", s.tolerance);
    visit("max_iterations", s.max_iterations);
    visit("relaxation", s.relaxation);
}

void for_each_setting(Is<Plane> auto& s, auto&& visit) {
    visit("normal", s.normal);
    visit("point", s.point);
}
void for_each_setting(Is<Sphere> auto& s, auto&& visit) {
    visit("radius", s.radius);
}
void for_each_setting(Is<Box> auto& s, auto&& visit) {
    visit("size", s.size);
}
void for_each_setting(Is<Capsule> auto& s, auto&& visit) {
    visit("radius", s.radius);
    visit("length", s.length);
}
void for_each_setting(Is<Cylinder> auto& s, auto&& visit) {
    visit("radius", s.radius);
    visit("height", s.height);
}
void for_each_setting(Is<Bucket> auto& s, auto&& visit) {
    visit("radius", s.radius);
    visit("height", s.height);
    visit("thickness", s.thickness);
}
void for_each_setting(Is<SurfaceMesh> auto& s, auto&& visit) {
    visit("nodes", s.nodes);
    visit("triangles", s.triangles);
}

/// True if the size of a struct is that of `numbers` values of type Real and one object of each type in `Parts`. If a
/// new member changes the size, the static_assert fails, and the member must be added to for_each_setting above.
template <class Struct, std::size_t numbers, class... Parts>
inline constexpr bool has_size = sizeof(Struct) == numbers * sizeof(Real) + (sizeof(Parts) + ... + 0);
static_assert(has_size<Settings, 17>);
static_assert(
    has_size<BodySettings, 35, std::map<int, MaterialHandle>, std::map<std::string, MaterialHandle>, std::string>);
static_assert(has_size<MaterialSettings, 23, OrthotropicModuli>);
static_assert(has_size<OrthotropicModuli, 15>);
static_assert(has_size<ColliderSettings, 16, Motion, std::string>);
static_assert(has_size<LoadSettings, 2>);
static_assert(has_size<SurfaceSettings, 8>);
static_assert(has_size<Pose, 6>);
static_assert(has_size<MotionKey, 7>);
static_assert(has_size<Motion, 6, std::vector<MotionKey>>);
static_assert(has_size<JointSettings, 16, std::optional<JointMotor>, JointPassive>);
static_assert(has_size<JointPassive, 4>);
static_assert(has_size<SpringSettings, 4, Anchor, Anchor, std::optional<TimeTable>>);
static_assert(has_size<MotorKey, 5>);
static_assert(has_size<JointMotor, 6, std::vector<MotorKey>>);
static_assert(has_size<TieSettings, 8, std::vector<Index>>);
static_assert(has_size<GasFilling, 4, TimeTable>);
static_assert(has_size<LiquidFilling, 2, std::optional<TimeTable>>);
static_assert(has_size<ProblemSettings, 4>);

/// True for the structs for which for_each_setting is defined above.
template <class T>
concept HasSettings = requires(T& settings) {
    for_each_setting(settings, [](const char*, auto&) {});
};

/// Name of the Python class of a struct.
template <class T>
inline constexpr const char* class_name = nullptr;
template <>
inline constexpr const char* class_name<Settings> = "Settings";
template <>
inline constexpr const char* class_name<MaterialSettings> = "Material";
template <>
inline constexpr const char* class_name<OrthotropicModuli> = "OrthotropicModuli";
template <>
inline constexpr const char* class_name<Plasticity> = "Plasticity";
template <>
inline constexpr const char* class_name<LoadSettings> = "LoadSettings";
template <>
inline constexpr const char* class_name<SurfaceSettings> = "Surface";
template <>
inline constexpr const char* class_name<Pose> = "Pose";
template <>
inline constexpr const char* class_name<MotionKey> = "MotionKey";
template <>
inline constexpr const char* class_name<Motion> = "Motion";
template <>
inline constexpr const char* class_name<JointPassive> = "JointPassive";
template <>
inline constexpr const char* class_name<MotorKey> = "MotorKey";
template <>
inline constexpr const char* class_name<JointMotor> = "Motor";
template <>
inline constexpr const char* class_name<GasFilling> = "Gas";
template <>
inline constexpr const char* class_name<LiquidFilling> = "Liquid";
template <>
inline constexpr const char* class_name<ProblemSettings> = "ProblemSettings";
template <>
inline constexpr const char* class_name<Plane> = "Plane";
template <>
inline constexpr const char* class_name<Sphere> = "Sphere";
template <>
inline constexpr const char* class_name<Box> = "Box";
template <>
inline constexpr const char* class_name<Capsule> = "Capsule";
template <>
inline constexpr const char* class_name<Cylinder> = "Cylinder";
template <>
inline constexpr const char* class_name<Bucket> = "Bucket";
template <>
inline constexpr const char* class_name<SurfaceMesh> = "SurfaceMesh";

}  // namespace skerry::python
