// Scenes, and the writers of pages, films, and files for ParaView.
#include "skerry/scene.h"

#include <string>
#include <utility>

#include "engine/python/world/parts.h"
#include "skerry/error.h"
#include "skerry/output.h"

namespace skerry::python {

namespace {

nb::dict values_of(Scene&& scene) {
    nb::list probes;
    for (const Probe& probe : scene.probes) probes.append(nb::make_tuple(probe.name, probe.body, probe.nodes));
    nb::dict values;
    values["name"] = scene.name;
    values["description"] = scene.description;
    values["materials"] = scene.materials;
    values["seconds"] = scene.seconds;
    values["frame_step"] = scene.frame_step;
    values["probe_step"] = scene.probe_step;
    values["contact_probes"] = probes;
    values["recorded"] = scene.recorded;
    values["sliders"] = scene.sliders;
    values["notes"] = scene.notes;
    values["world"] = nb::cast(new WorldObject(std::move(scene.world)), nb::rv_policy::take_ownership);
    return values;
}

SceneOverrides overrides_of(const std::vector<std::string>& assignments, std::optional<int> threads,
                            const std::string& python) {
    SceneOverrides overrides{.threads = threads};
    overrides.assignments = assignments;
    overrides.fill_python = python;
    return overrides;
}

/// Called repeatedly while a surface is filled. Throws if Ctrl-C was pressed, which ends the filling.
void poll_signals(const std::string&) {
    const nb::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

nb::dict load(const std::string& file, const std::vector<std::string>& assignments, std::optional<int> threads,
              const std::string& python) {
    return values_of(
        without_gil([&] { return load_scene(file, overrides_of(assignments, threads, python), poll_signals); }));
}

nb::dict load_text(const std::string& json, const std::string& folder, const std::vector<std::string>& assignments,
                   std::optional<int> threads, const std::string& python) {
    return values_of(without_gil(
        [&] { return load_scene_text(json, folder, overrides_of(assignments, threads, python), poll_signals); }));
}

FilmColor film_color(const std::string& name) {
    if (const auto known = from_name<FilmColor>(name)) return *known;
    Complaint{.file = {},
              .object = "film",
              .field = "color",
              .found = "'" + name + "'",
              .expected = "'none', 'stress', 'speed' or 'contact'",
              .hint = {}}
        .raise();
}

}  // namespace

void bind_scene(nb::module_& module) {
    nb::class_<Slider>(module, "Slider")
        .def_ro("name", &Slider::name)
        .def_ro("unit", &Slider::unit)
        .def_ro("low", &Slider::low)
        .def_ro("high", &Slider::high)
        .def_ro("fastest", &Slider::fastest);
    module.def("slider_value", guarded([](World& world, const Slider& slider) { return slider_value(world, slider); }));
    module.def("set_slider",
               guarded([](World& world, const Slider& slider, Real value) { set_slider(world, slider, value); }));
    module.def("load_scene", &load, nb::arg(), nb::arg(), nb::arg().none(), nb::arg());
    module.def("load_scene_text", &load_text, nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg());
    module.def("scene_schema", &scene_schema);

    nb::class_<VtkWriter>(module, "VtkWriter")
        .def("__init__", [](VtkWriter* self, const std::string& folder,
                            const std::string& name) { new (self) VtkWriter(folder, name); })
        .def("name_materials", &VtkWriter::name_materials)
        .def("add_frame",
             [](VtkWriter& writer, WorldObject& object) {
                 Use use(object);
                 without_gil([&] { writer.write_frame(object.world); });
             })
        .def("close", &VtkWriter::close);
    nb::class_<PageWriter>(module, "PageWriter")
        .def("__init__", [](PageWriter* self, const std::string& file,
                            const std::string& title) { new (self) PageWriter(file, title); })
        .def("add_frame",
             [](PageWriter& writer, WorldObject& object) {
                 Use use(object);
                 without_gil([&] { writer.add_frame(object.world); });
             })
        .def("close", [](PageWriter& writer, WorldObject& object) {
            Use use(object);
            without_gil([&] { writer.close(object.world); });
        });
    nb::class_<FilmWriter>(module, "FilmWriter")
        .def(
            "__init__",
            [](FilmWriter* self, const std::string& file, Real frame_step, const std::string& color,
               std::optional<Real> color_max) {
                new (self)
                    FilmWriter(file, {.frame_step = frame_step, .color = film_color(color), .color_max = color_max});
            },
            nb::arg(), nb::arg(), nb::arg(), nb::arg().none())
        .def("add_frame",
             [](FilmWriter& writer, WorldObject& object) {
                 Use use(object);
                 without_gil([&] { writer.add_frame(object.world); });
             })
        .def("close", [](FilmWriter& writer) { return without_gil([&] { return writer.close(); }); });
    module.def(
        "write_gltf",
        [](WorldObject& object, const std::string& file, const std::string& color, std::optional<Real> color_max) {
            Use use(object);
            without_gil([&] { write_gltf(object.world, file, film_color(color), color_max); });
        },
        nb::arg(), nb::arg(), nb::arg(), nb::arg().none());
}

}  // namespace skerry::python
