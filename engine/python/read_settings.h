// Conversion of settings from and to Python. The dataclasses of skerry/_settings.py have fields with the names of the
// members of the C++ structs.
#pragma once

#include "engine/python/bind.h"
#include "skerry/cable.h"
#include "skerry/cavity.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "skerry/problem.h"
#include "skerry/spring.h"
#include "skerry/tie.h"
#include "skerry/time_table.h"
#include "skerry/world.h"

namespace skerry::python {

/// Reads the attributes of a Python object into a struct of settings. A missing attribute leaves the member unchanged.
/// If a value has the wrong type, throws a SceneError that names the field and the object. The name of the object is
/// its attribute `of`, or its class if it has none. Handles of materials and bodies are not read: Python passes them as
/// arguments.
void read(nb::handle object, Settings& settings);
void read(nb::handle object, MaterialSettings& settings);
void read(nb::handle object, OrthotropicModuli& settings);
void read(nb::handle object, BodySettings& settings);
void read(nb::handle object, ColliderSettings& settings);
void read(nb::handle object, LoadSettings& settings);
void read(nb::handle object, SurfaceSettings& settings);
void read(nb::handle object, Pose& settings);
void read(nb::handle object, Motion& settings);
void read(nb::handle object, JointSettings& settings);
void read(nb::handle object, JointPassive& settings);
void read(nb::handle object, JointMotor& settings);
void read(nb::handle object, TieSettings& settings);
void read(nb::handle object, GasFilling& settings);
void read(nb::handle object, LiquidFilling& settings);
void read(nb::handle object, SpringSettings& settings);
void read(nb::handle object, ProblemSettings& settings);

/// Reads a Plane, a Sphere or another of the shapes. The class of the Python object has the name of the C++ struct.
Shape read_shape(nb::handle object);

/// Returns the table of the pairs (time, value) that Python passes for a value that changes over time.
TimeTable table_of(const std::vector<std::array<Real, 2>>& pairs);

/// The values of a struct by name, as Python values.
nb::dict values_of(const Settings& settings);
nb::dict values_of(const MaterialSettings& settings);
nb::dict values_of(const SpringSettings& settings);
nb::dict values_of(const CableSettings& settings);
nb::dict values_of(const TieSettings& settings);
nb::dict values_of(const JointSettings& settings);
nb::dict values_of(const PipeSettings& settings);
nb::dict values_of(const AnyLoad& settings);

/// Returns the Python object of a shape or of settings: an instance of its dataclass.
nb::object object_of(const Shape& shape);
nb::object object_of(const Pose& pose);
nb::object object_of(const JointMotor& motor);
nb::object object_of(const JointPassive& passive);
nb::object object_of(const SurfaceSettings& surface);
nb::object object_of(const GasFilling& gas);
nb::object object_of(const LiquidFilling& liquid);
/// Returns the pairs (time, value) of a table.
nb::object object_of(const TimeTable& table);

}  // namespace skerry::python
