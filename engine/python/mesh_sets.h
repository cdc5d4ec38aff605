// Conversion of named sets of meshes. In Python a set is a tuple of arrays: nodes, faces and tetrahedra.
#pragma once

#include <map>
#include <string>

#include "engine/python/bind.h"
#include "skerry/mesh.h"

namespace skerry::python {

inline nb::tuple arrays_of(const MeshSet& set) {
    return nb::make_tuple(array_of<Index>(std::span<const Index>(set.nodes)),
                          array_of<Index>(std::span<const std::array<Index, 3>>(set.faces), {3}),
                          array_of<Index>(std::span<const Index>(set.tetrahedra)));
}

inline MeshSet set_of(const Indices& nodes, const IndexRows<3>& faces, const Indices& tetrahedra) {
    const auto n = span_of(nodes), t = span_of(tetrahedra);
    const auto f = span_of(faces);
    return {.nodes = {n.begin(), n.end()}, .faces = {f.begin(), f.end()}, .tetrahedra = {t.begin(), t.end()}};
}

inline std::map<std::string, MeshSet> sets_of(const nb::dict& given) {
    std::map<std::string, MeshSet> sets;
    for (const auto& [name, arrays] : given)
        sets[nb::cast<std::string>(name)] =
            set_of(nb::cast<Indices>(arrays[0]), nb::cast<IndexRows<3>>(arrays[1]), nb::cast<Indices>(arrays[2]));
    return sets;
}

}  // namespace skerry::python
