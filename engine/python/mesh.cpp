// Tetrahedral meshes and surfaces.
#include "skerry/mesh.h"

#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "engine/python/mesh_sets.h"
#include "engine/python/world/parts.h"
#include "skerry/fill.h"
#include "skerry/refine.h"
#include "skerry/surface_check.h"

namespace skerry::python {

namespace {

using Notes = std::vector<std::string>;

/// Mesh with exactly these arrays: unlike in new_mesh(), inverted tetrahedra are kept.
Mesh same_mesh(const Vectors& nodes, const IndexRows<4>& tetrahedra, const std::optional<Indices>& labels,
               const std::optional<Indices>& file_number, const nb::dict& sets) {
    const auto points = span_of(nodes);
    const auto rows = span_of(tetrahedra);
    Mesh mesh{.nodes{points.begin(), points.end()}, .tetrahedra{rows.begin(), rows.end()}};
    if (labels) mesh.label.assign(span_of(*labels).begin(), span_of(*labels).end());
    if (file_number) mesh.file_number.assign(span_of(*file_number).begin(), span_of(*file_number).end());
    mesh.sets = sets_of(sets);
    return mesh;
}

/// Returns a mesh in which inverted tetrahedra are turned to positive volume, and notes about these tetrahedra.
nb::tuple new_mesh(const Vectors& nodes, const IndexRows<4>& tetrahedra, const std::optional<Indices>& labels,
                   const nb::dict& sets) {
    Mesh mesh = same_mesh(nodes, tetrahedra, labels, {}, sets);
    Notes notes;
    mesh::turn_inverted(mesh, "mesh", &notes);
    return nb::make_tuple(std::move(mesh), notes);
}

nb::tuple arrays_of(const SurfaceMesh& surface) {
    return nb::make_tuple(array_of(surface.nodes),
                          array_of<Index>(std::span<const std::array<Index, 3>>(surface.triangles), {3}));
}

nb::tuple read(const std::string& path, Real scale) {
    Notes notes;
    Mesh mesh = without_gil([&] { return mesh::read(path, &notes); });
    for (Vec3& node : mesh.nodes) node *= scale;
    return nb::make_tuple(std::move(mesh), notes);
}

nb::tuple read_surface(const std::string& path, Real scale) {
    Notes notes;
    SurfaceMesh surface = without_gil([&] { return mesh::read_surface(path, &notes); });
    for (Vec3& node : surface.nodes) node *= scale;
    return nb::make_tuple(arrays_of(surface), notes);
}

/// Fills a surface with tetrahedra. The surface is given by a list of file names, or by arrays of nodes and triangles.
/// Returns the mesh and notes about it.
nb::tuple fill(const std::variant<std::vector<std::string>, std::tuple<Vectors, IndexRows<3>>>& surfaces, Real scale,
               std::optional<Real> edge, Real tolerance, bool cavities, Real seconds, Real bytes,
               const std::string& python) {
    const mesh::FillSettings settings{.scale = scale,
                                      .edge = edge,
                                      .tolerance = tolerance,
                                      .cavities = cavities,
                                      .limits = {.seconds = seconds, .bytes = bytes},
                                      .python = python};
    const auto poll = [](const std::string&) {
        const nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
    };
    if (const auto* names = std::get_if<0>(&surfaces)) {
        const std::vector<std::filesystem::path> files(names->begin(), names->end());
        mesh::FilledMesh filled = without_gil([&] { return mesh::fill(files, settings, poll); });
        return nb::make_tuple(std::move(filled.mesh), filled.notes);
    }
    const auto& [nodes, triangles] = std::get<1>(surfaces);
    const auto points = span_of(nodes);
    const auto rows = span_of(triangles);
    const SurfaceMesh surface{.nodes{points.begin(), points.end()}, .triangles{rows.begin(), rows.end()}};
    mesh::FilledMesh filled = without_gil([&] { return mesh::fill(surface, "surface", settings, poll); });
    return nb::make_tuple(std::move(filled.mesh), filled.notes);
}

Mesh table(Real length, Real width, Real height, Real thickness, Real leg, int cells_per_leg) {
    return mesh::table({.length = length,
                        .width = width,
                        .height = height,
                        .thickness = thickness,
                        .leg = leg,
                        .cells_per_leg = cells_per_leg});
}

Mesh lathe(const nb::ndarray<const Real, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>& profile, int resolution) {
    const auto* points = reinterpret_cast<const std::array<Real, 2>*>(profile.data());
    return mesh::lathe({points, profile.shape(0)}, resolution);
}

nb::dict inspect_mesh(const Mesh& mesh) {
    const MeshReport report = without_gil([&] { return inspect(mesh); });
    nb::dict values;
    values["nodes"] = report.nodes;
    values["tetrahedra"] = report.tetrahedra;
    values["boundary_triangles"] = report.boundary_triangles;
    values["components"] = report.components;
    values["lower"] = tuple_of(report.lower);
    values["upper"] = tuple_of(report.upper);
    values["volume"] = report.volume;
    values["mean_edge"] = report.mean_edge;
    values["min_edge"] = report.min_edge;
    values["max_edge"] = report.max_edge;
    values["min_altitude"] = report.min_altitude;
    values["min_quality"] = report.min_quality;
    values["mean_quality"] = report.mean_quality;
    values["inverted"] = report.inverted;
    values["flat"] = report.flat;
    values["slivers"] = report.slivers;
    values["closed_manifold"] = report.closed_manifold;
    values["boundary_fault"] = report.boundary_fault;
    nb::dict labels;
    for (const auto& [label, count] : report.labels) labels[nb::cast(label)] = count;
    values["labels"] = labels;
    nb::dict sets;
    for (const auto& [name, count] : report.sets) sets[nb::cast(name)] = nb::make_tuple(count[0], count[1], count[2]);
    values["sets"] = sets;
    return values;
}

nb::dict check_surface(const Vectors& nodes, const IndexRows<3>& triangles, Real tolerance) {
    const auto points = span_of(nodes);
    const auto rows = span_of(triangles);
    const SurfaceMesh surface{{points.begin(), points.end()}, {rows.begin(), rows.end()}};
    const SurfaceReport report = without_gil([&] { return mesh::check_surface(surface, tolerance); });
    const auto row_or_none = [](Index row) { return row == no_index ? nb::none() : nb::cast(row); };
    nb::list faults, shells;
    for (const SurfaceFault& fault : report.faults) {
        nb::dict values;
        values["kind"] = std::string(name_of(fault.kind));
        values["count"] = fault.count;
        values["triangle"] = fault.triangle;
        values["other"] = row_or_none(fault.other);
        values["place"] = tuple_of(fault.place);
        values["length"] = fault.length;
        values["text"] = mesh::fault_text(fault);
        faults.append(values);
    }
    for (const SurfaceShell& shell : report.shells) {
        nb::dict values;
        values["triangles"] = shell.triangles;
        values["triangle"] = shell.triangle;
        values["closed"] = shell.closed;
        values["volume"] = shell.volume;
        values["around"] = row_or_none(shell.around);
        shells.append(values);
    }
    nb::dict values;
    values["faults"] = faults;
    values["shells"] = shells;
    values["can_be_filled"] = report.can_be_filled();
    values["tolerance"] = std::max(report.tolerance, Real(0));
    values["merged"] = report.merged;
    values["lower"] = tuple_of(report.lower);
    values["upper"] = tuple_of(report.upper);
    values["area"] = report.area;
    values["volume"] = report.volume;
    values["min_edge"] = report.min_edge;
    values["mean_edge"] = report.mean_edge;
    values["max_edge"] = report.max_edge;
    values["cleaned"] = arrays_of(report.cleaned);
    values["number"] = array_of<Index>(std::span<const Index>(report.number));
    values["shell"] = array_of<Index>(std::span<const Index>(report.shell));
    return values;
}

}  // namespace

void bind_mesh(nb::module_& module) {
    nb::class_<Mesh>(module, "Mesh")
        .def("nodes", [](const Mesh& mesh) { return array_of(mesh.nodes); })
        .def("tetrahedra",
             [](const Mesh& mesh) {
                 return array_of<Index>(std::span<const std::array<Index, 4>>(mesh.tetrahedra), {4});
             })
        .def("labels",
             [](const Mesh& mesh) -> nb::object {
                 if (mesh.label.empty()) return nb::none();
                 return nb::cast(array_of<Index>(std::span<const int>(mesh.label)));
             })
        .def("file_number",
             [](const Mesh& mesh) -> nb::object {
                 if (mesh.file_number.empty()) return nb::none();
                 return nb::cast(array_of<Index>(std::span<const Index>(mesh.file_number)));
             })
        .def("sets", [](const Mesh& mesh) {
            nb::dict sets;
            for (const auto& [name, set] : mesh.sets) sets[nb::cast(name)] = arrays_of(set);
            return sets;
        });
    module.def("new_mesh", &new_mesh, nb::arg(), nb::arg(), nb::arg().none(), nb::arg());
    module.def("same_mesh", &same_mesh, nb::arg(), nb::arg(), nb::arg().none(), nb::arg().none(), nb::arg());
    module.def("read_mesh", &read);
    module.def("read_surface", &read_surface);
    module.def("fill", &fill, nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg(), nb::arg(), nb::arg(),
               nb::arg());
    module.def("box", [](const Vec3& size, const std::array<int, 3>& cells) { return mesh::box(size, cells); });
    module.def("ball", &mesh::ball);
    module.def("cylinder", &mesh::cylinder);
    module.def("lathe", &lathe);
    module.def("skittle", &mesh::skittle);
    module.def("table", &table);
    module.def("write_mesh",
               [](const std::string& path, const Mesh& mesh) { without_gil([&] { mesh::write(path, mesh); }); });
    module.def("boundary", [](const Mesh& mesh) {
        const SurfaceMesh surface = without_gil([&] { return mesh::boundary(mesh); });
        return arrays_of(surface);
    });
    module.def("inspect", &inspect_mesh);
    module.def("refine", [](const Mesh& mesh) { return without_gil([&] { return mesh::refine(mesh); }); });
    module.def("check_surface", &check_surface);
}

}  // namespace skerry::python
