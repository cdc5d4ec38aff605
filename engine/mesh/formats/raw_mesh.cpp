#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

void NodeNumbers::add(std::int64_t number, const FileReader& reader) {
    if (!row_.try_emplace(number, static_cast<Index>(row_.size())).second)
        reader.complain("number", std::to_string(number) + " a second time", "a number of its own for each node");
}

Index NodeNumbers::row(std::int64_t number, const FileReader& reader) const {
    const auto place = row_.find(number);
    if (place == row_.end()) reader.complain("node", std::to_string(number), "the number of a node of the file");
    return place->second;
}

}  // namespace skerry::mesh
