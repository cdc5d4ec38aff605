// Time series of probes.
#include "skerry/recorder.h"

#include <string>
#include <utility>

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

using Point = std::optional<std::array<Real, 3>>;
using Posed = std::variant<BodyHandle, ColliderHandle, AttachmentHandle>;

std::optional<Vec3> vector_of(const Point& point) {
    if (!point) return {};
    return Vec3((*point)[0], (*point)[1], (*point)[2]);
}

nb::object tuple_of_point(const std::optional<Vec3>& point) {
    return point ? nb::object(tuple_of(*point)) : nb::none();
}

/// Returns the members of a probe, preceded by the name of its Python class (see skerry/_world/probes.py).
nb::tuple values_of(const RecordedProbe& probe) {
    nb::dict values;
    const char* kind = std::visit(
        [&]<class Kind>(const Kind& object) {
            if constexpr (std::is_same_v<Kind, PointProbe>) {
                values["body"] = object.body;
                values["node"] = object.node;
                values["weight"] = object.weight;
                values["origin"] = tuple_of_point(object.origin);
                return "PointProbe";
            } else if constexpr (std::is_same_v<Kind, BodyProbe>) {
                values["body"] = object.body;
                values["origin"] = tuple_of_point(object.origin);
                return "BodyProbe";
            } else if constexpr (std::is_same_v<Kind, BodyForceProbe>) {
                values["on"] = object.body;
                values["by"] = object.by ? nb::cast(*object.by) : nb::none();
                return "ForceProbe";
            } else if constexpr (std::is_same_v<Kind, ColliderForceProbe>) {
                values["on"] = object.collider;
                values["by"] = object.by ? nb::cast(*object.by) : nb::none();
                return "ForceProbe";
            } else if constexpr (std::is_same_v<Kind, ReactionProbe>) {
                values["attachment"] = object.attachment;
                return "ReactionProbe";
            } else if constexpr (std::is_same_v<Kind, JointProbe>) {
                values["joint"] = object.joint;
                return "JointProbe";
            } else if constexpr (std::is_same_v<Kind, TieProbe>) {
                values["tie"] = object.tie;
                return "TieProbe";
            } else if constexpr (std::is_same_v<Kind, CableProbe>) {
                values["cable"] = object.cable;
                return "CableProbe";
            } else if constexpr (std::is_same_v<Kind, CavityProbe>) {
                values["cavity"] = object.cavity;
                return "CavityProbe";
            } else if constexpr (std::is_same_v<Kind, SpringProbe>) {
                values["spring"] = object.spring;
                return "SpringProbe";
            } else if constexpr (std::is_same_v<Kind, EnergyProbe>) {
                return "EnergyProbe";
            } else if constexpr (std::is_same_v<Kind, StressProbe>) {
                values["body"] = object.body;
                values["nodes"] = object.nodes;
                return "StressProbe";
            } else if constexpr (std::is_same_v<Kind, VolumeProbe>) {
                values["body"] = object.body;
                return "VolumeProbe";
            } else if constexpr (std::is_same_v<Kind, PoseProbe>) {
                values["object"] = object.object;
                return "PoseProbe";
            } else if constexpr (std::is_same_v<Kind, VelocityProbe>) {
                values["object"] = object.object;
                return "VelocityProbe";
            } else {
                static_assert(std::is_same_v<Kind, NodesProbe>);
                values["body"] = object.body;
                return "NodesProbe";
            }
        },
        probe.what);
    return nb::make_tuple(kind, values);
}

/// Adds the class RecordedProbe, and a function of the module for each kind of probe.
void bind_probes(nb::module_& module) {
    nb::class_<RecordedProbe>(module, "RecordedProbe")
        .def_ro("name", &RecordedProbe::name)
        .def_prop_ro("values", [](const RecordedProbe& probe) { return values_of(probe); });
    module.def(
        "point_probe",
        [](const std::string& name, const BodyHandle& body, const std::array<Index, 4>& node,
           const std::array<Real, 4>& weight, const Point& origin) {
            return RecordedProbe{name, PointProbe{body, node, weight, vector_of(origin)}};
        },
        nb::arg(), nb::arg(), nb::arg(), nb::arg(), nb::arg().none());
    module.def(
        "body_probe",
        [](const std::string& name, const BodyHandle& body, const Point& origin) {
            return RecordedProbe{name, BodyProbe{body, vector_of(origin)}};
        },
        nb::arg(), nb::arg(), nb::arg().none());
    module.def(
        "force_probe",
        [](const std::string& name, const BodyHandle& on,
           const std::optional<std::variant<BodyHandle, ColliderHandle>>& by) {
            return RecordedProbe{name, BodyForceProbe{on, by}};
        },
        nb::arg(), nb::arg(), nb::arg().none());
    module.def(
        "force_probe",
        [](const std::string& name, const ColliderHandle& on, const std::optional<BodyHandle>& by) {
            return RecordedProbe{name, ColliderForceProbe{on, by}};
        },
        nb::arg(), nb::arg(), nb::arg().none());
    module.def("reaction_probe", [](const std::string& name, const AttachmentHandle& attachment) {
        return RecordedProbe{name, ReactionProbe{attachment}};
    });
    module.def("joint_probe", [](const std::string& name, const JointHandle& joint) {
        return RecordedProbe{name, JointProbe{joint}};
    });
    module.def("tie_probe", [](const std::string& name, const TieHandle& tie) {
        return RecordedProbe{name, TieProbe{tie}};
    });
    module.def("cable_probe", [](const std::string& name, const CableHandle& cable) {
        return RecordedProbe{name, CableProbe{cable}};
    });
    module.def("cavity_probe", [](const std::string& name, const CavityHandle& cavity) {
        return RecordedProbe{name, CavityProbe{cavity}};
    });
    module.def("spring_probe", [](const std::string& name, const SpringHandle& spring) {
        return RecordedProbe{name, SpringProbe{spring}};
    });
    module.def("energy_probe", [](const std::string& name) { return RecordedProbe{name, EnergyProbe{}}; });
    module.def("stress_probe", [](const std::string& name, const BodyHandle& body, const std::vector<Index>& nodes) {
        return RecordedProbe{name, StressProbe{body, nodes}};
    });
    module.def("volume_probe", [](const std::string& name, const BodyHandle& body) {
        return RecordedProbe{name, VolumeProbe{body}};
    });
    module.def("pose_probe", [](const std::string& name, const Posed& object) {
        return RecordedProbe{name, PoseProbe{object}};
    });
    module.def("velocity_probe", [](const std::string& name, const Posed& object) {
        return RecordedProbe{name, VelocityProbe{object}};
    });
    module.def("nodes_probe", [](const std::string& name, const BodyHandle& body) {
        return RecordedProbe{name, NodesProbe{body}};
    });
    module.def("probe_point", [](WorldObject& object, const BodyHandle& body, const Vec3& point) {
        Use use(object);
        return values_of(RecordedProbe{{}, probe_point(object.world, body, point)});
    });
}

nb::list columns_of(const Recorder& recorder) {
    nb::list columns;
    for (const SeriesColumn& column : recorder.columns())
        columns.append(nb::make_tuple(column.probe, column.quantity, column.unit, column.heading()));
    return columns;
}

/// Returns all rows of numbers, one after the other in a flat array. Python gives the array the shape (rows, columns).
nb::ndarray<nb::numpy, Real> table_of(const Recorder& recorder) {
    std::vector<Real> values;
    values.reserve(recorder.row_count() * recorder.columns().size());
    for (std::size_t row = 0; row < recorder.row_count(); ++row) {
        const std::span<const Real> numbers = recorder.row(row);
        values.insert(values.end(), numbers.begin(), numbers.end());
    }
    return array_of<Real>(std::span<const Real>(values));
}

}  // namespace

void bind_recorder(nb::module_& module) {
    bind_probes(module);
    nb::class_<Recorder>(module, "Recorder")
        .def("__init__",
             [](Recorder* self, WorldObject& object, std::vector<RecordedProbe> probes, Real every) {
                 Use use(object);
                 new (self) Recorder(object.world, std::move(probes), every);
             })
        .def("sample",
             [](Recorder& recorder, WorldObject& object) {
                 Use use(object);
                 recorder.sample(object.world);
             })
        .def("row_count", &Recorder::row_count)
        .def("columns", &columns_of)
        .def("table", &table_of)
        .def("stream_csv", [](Recorder& recorder, const std::string& file) { recorder.stream_csv(file); })
        .def("write_csv", [](const Recorder& recorder, const std::string& file) { recorder.write_csv(file); })
        .def("write_hdf5", [](const Recorder& recorder, const std::string& file) { recorder.write_hdf5(file); });
}

}  // namespace skerry::python
