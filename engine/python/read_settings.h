// Settings from Python: the dataclasses of skerry/_settings.py have the names of the members of the C++ structs.
#pragma once

#include "engine/python/bind.h"
#include "skerry/world.h"

namespace skerry::python {

/// Reads the attributes of a Python object into a struct of settings. A missing attribute leaves the default. Throws
/// SceneError that names object and field if a value has the wrong type.
void read(nb::handle from, Settings& to);
void read(nb::handle from, MaterialSettings& to);
void read(nb::handle from, BodySettings& to);  // without the materials, which Python passes as handles

/// The values of a struct by name, as Python values.
nb::dict values_of(const Settings& settings);
nb::dict values_of(const MaterialSettings& settings);

}  // namespace skerry::python
