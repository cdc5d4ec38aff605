// Visual surfaces of bodies.
#include "skerry/visual.h"

#include <nanobind/stl/tuple.h>

#include <string>
#include <tuple>
#include <utility>

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using TexturePoints = nb::ndarray<const Real, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
/// Name, colour, opacity and path of the texture image of a material.
using MaterialTuple = std::tuple<std::string, std::array<Real, 3>, Real, std::string>;

VisualSurface new_visual(const Vectors& nodes, const IndexRows<3>& triangles, const TexturePoints& texture_points,
                         const IndexRows<3>& texture_corners, const std::vector<MaterialTuple>& materials,
                         const Indices& material, const std::string& file) {
    const auto list = [](const auto& rows) { return std::vector(rows.begin(), rows.end()); };
    const auto* points = reinterpret_cast<const std::array<Real, 2>*>(texture_points.data());
    VisualSurface surface{.nodes = list(span_of(nodes)),
                          .triangles = list(span_of(triangles)),
                          .texture_points{points, points + texture_points.shape(0)},
                          .texture_corners = list(span_of(texture_corners)),
                          .material = list(span_of(material)),
                          .file = file};
    for (const auto& [name, color, opacity, texture] : materials)
        surface.materials.push_back({name, color, opacity, texture});
    return surface;
}

nb::tuple read_visual(const std::string& path, Real scale) {
    std::vector<std::string> notes;
    VisualSurface surface = without_gil([&] { return mesh::read_visual(path, &notes); });
    for (Vec3& node : surface.nodes) node *= scale;
    return nb::make_tuple(std::move(surface), notes);
}

nb::ndarray<nb::numpy, Index> corners_of(const std::vector<std::array<Index, 3>>& rows) {
    return array_of<Index>(std::span<const std::array<Index, 3>>(rows), {3});
}

}  // namespace

void bind_visual_surface(nb::module_& module) {
    nb::class_<VisualSurface>(module, "VisualSurface")
        .def("nodes", [](const VisualSurface& surface) { return array_of(surface.nodes); })
        .def("triangles", [](const VisualSurface& surface) { return corners_of(surface.triangles); })
        .def("texture_points",
             [](const VisualSurface& surface) {
                 return array_of<Real>(std::span<const std::array<Real, 2>>(surface.texture_points), {2});
             })
        .def("texture_corners", [](const VisualSurface& surface) { return corners_of(surface.texture_corners); })
        .def("materials",
             [](const VisualSurface& surface) {
                 std::vector<MaterialTuple> materials;
                 for (const VisualMaterial& material : surface.materials)
                     materials.emplace_back(material.name, material.color, material.opacity, material.texture);
                 return materials;
             })
        .def("material",
             [](const VisualSurface& surface) { return array_of<Index>(std::span<const Index>(surface.material)); })
        .def("file", [](const VisualSurface& surface) { return surface.file; })
        .def("equals", [](const VisualSurface& surface, const VisualSurface& other) { return surface == other; });
    module.def("new_visual", &new_visual);
    module.def("read_visual", &read_visual);
}

void bind_visuals(WorldClass& type) {
    type.def("set_visual", guarded([](World& world, const BodyHandle& body, const VisualSurface& surface) {
                 return Visuals(world).set(body, surface).warning;
             }))
        .def("remove_visual", guarded([](World& world, const BodyHandle& body) { Visuals(world).remove(body); }))
        .def("visual", guarded([](World& world, const BodyHandle& body) -> std::optional<VisualSurface> {
                 const VisualSurface* const surface = Visuals(world).get(body);
                 return surface ? std::optional(*surface) : std::nullopt;
             }))
        .def("visual_positions",
             guarded([](World& world, const BodyHandle& body) { return array_of(Visuals(world).positions(body)); }));
}

}  // namespace skerry::python
