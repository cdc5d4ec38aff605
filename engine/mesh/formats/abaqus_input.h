// The keyword lines and data lines of an Abaqus input file.
#pragma once

#include <functional>

#include "engine/mesh/formats/raw_mesh.h"

namespace skerry::mesh {

/// A keyword line such as "*ELEMENT, TYPE=C3D4, ELSET=BEAM", and the place of the data lines that follow it.
struct AbaqusBlock {
    std::string keyword;                           // upper case, without the asterisk
    std::map<std::string, std::string> parameter;  // values by names in upper case; a parameter without value has ""
    std::size_t place = 0;                         // position of the keyword line in the file [bytes]
    std::size_t first = 0, end = 0;                // begin and end of its data lines in the file [bytes]

    bool has(const char* name) const { return parameter.contains(name); }
    /// Value of the parameter `name`; empty if the parameter is missing or has no value.
    std::string value(const char* name) const;
};

/// Reads the keyword lines of the whole file.
std::vector<AbaqusBlock> abaqus_blocks(FileReader& reader);

/// Calls `take` with the fields of each row of a block, in which commas separate the fields. A row continues in the
/// next line if it has fewer than `fields` fields and its line ends with a comma. Error messages name the block and the
/// last line of the row.
void for_each_abaqus_row(FileReader& reader, const AbaqusBlock& block, std::size_t fields,
                         const std::function<void(const std::vector<std::string>&)>& take);

/// Moves the reader to the keyword line of a block, so that the next error message names this line.
void go_to_keyword(FileReader& reader, const AbaqusBlock& block);

}  // namespace skerry::mesh
