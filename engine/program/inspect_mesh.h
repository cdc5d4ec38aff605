// Reports on mesh files. Some of the functions are also used for reports on scenes.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "engine/program/commands.h"
#include "engine/program/mesh_text.h"
#include "engine/program/step_bound.h"
#include "engine/scene/place.h"
#include "skerry/mesh.h"

namespace skerry {

/// Adds a problem if a thin part of the mesh is too stiff in bending, or if elements lock (are far too stiff in
/// bending, because the material is nearly incompressible).
/// - `boundary`: boundary triangles of the mesh.
/// - `body_case`: materials and elements of the body.
void add_thin_part(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary, const BodyCase& body_case,
                   Problems& problems);
void print_notes(const std::vector<std::string>& notes);
void print_problems(const Problems& problems);
Json bound_json(const StepBound& bound);

/// Prints the tetrahedra that limit the stable step, and the stable step of the mesh without its worst tetrahedra.
void print_bound(const StepBound& bound, const char* indent);

/// Prints a report on a mesh file, or on the surface in a file that has no tetrahedra. Returns the exit code of the
/// program.
int inspect_mesh(const InspectOptions& options);

}  // namespace skerry
