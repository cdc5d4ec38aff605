// Named sets of bodies.
#include "skerry/sets.h"

#include "engine/python/mesh_sets.h"
#include "engine/python/world/parts.h"

namespace skerry::python {

void bind_sets(WorldClass& type) {
    type.def("set_names", guarded([](World& world, const BodyHandle& body) { return Sets(world).names(body); }))
        .def("get_set", guarded([](World& world, const BodyHandle& body, const std::string& name) {
                 return arrays_of(Sets(world).get(body, name));
             }))
        .def("add_set", guarded([](World& world, const BodyHandle& body, const std::string& name, const Indices& nodes,
                                   const IndexRows<3>& faces, const Indices& tetrahedra) {
                 Sets(world).add(body, name, set_of(nodes, faces, tetrahedra));
             }))
        .def("remove_set", guarded([](World& world, const BodyHandle& body, const std::string& name) {
                 Sets(world).remove(body, name);
             }))
        .def("set_nodes", guarded([](World& world, const BodyHandle& body, const std::string& name) {
                 const std::vector<Index> nodes = Sets(world).nodes(body, name);
                 return array_of<Index>(std::span<const Index>(nodes));
             }))
        .def("set_faces", guarded([](World& world, const BodyHandle& body, const std::string& name) {
                 const std::vector<std::array<Index, 3>> faces = Sets(world).faces(body, name);
                 return array_of<Index>(std::span<const std::array<Index, 3>>(faces), {3});
             }))
        .def("set_tetrahedra", guarded([](World& world, const BodyHandle& body, const std::string& name) {
                 const std::vector<Index> tetrahedra = Sets(world).tetrahedra(body, name);
                 return array_of<Index>(std::span<const Index>(tetrahedra));
             }))
        .def("labels",
             guarded([](World& world, const BodyHandle& body) { return array_of<Index>(Sets(world).labels(body)); }));
}

}  // namespace skerry::python
