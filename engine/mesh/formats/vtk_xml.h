// VTK XML files: tags, and the arrays of numbers that they describe. Format: "VTK File Formats", XML file formats.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/mesh/formats/file_reader.h"

namespace skerry::mesh {

/// A tag of an XML file: <name> (opens), </name> (closes) or <name/> (opens and closes).
struct XmlTag {
    std::string_view name;
    bool opens = true, closes = false;
    std::vector<std::pair<std::string_view, std::string_view>> attributes;
    std::size_t place = 0;  // offset of the first byte of the tag in the file
    std::size_t end = 0;    // offset of the first byte after the tag

    /// Returns the value of an attribute, or `otherwise` if the tag does not have the attribute.
    std::string_view value_of(std::string_view attribute, std::string_view otherwise = {}) const;
};

/// Returns the next tag, and moves the reader to the byte after it. Skips text, comments and processing instructions.
/// Throws SceneError at the end of the file.
XmlTag next_tag(FileReader& reader);

/// Bytes of the whole file, including those that were already read.
std::string_view bytes_of(const FileReader& reader);

/// An array of a VTK XML file.
struct VtkXmlArray {
    XmlTag tag;
    std::string_view text;  // text between the tags; empty if the data are appended
    std::string section;    // description of the array for error messages
};

/// Encoding of all arrays of a file. The attributes of <VTKFile> and <AppendedData> define it.
struct VtkXmlForm {
    bool wide_header = false;    // headers (sizes before the data of an array) have 64 instead of 32 bits
    bool swapped_bytes = false;  // byte order of the file differs from the order of this machine
    bool compressed = false;
    bool has_appended = false, appended_base64 = false;
    std::string_view appended;  // bytes after the "_" of <AppendedData>; if they are raw: up to the end of the file
};

/// Reads the numbers of an array. Throws SceneError unless the array has exactly `count` numbers. `field` names the
/// numbers in error messages.
std::vector<Real> reals_of(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t count, const char* field,
                           FileReader& reader);
std::vector<std::int64_t> integers_of(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t count,
                                      const char* field, FileReader& reader);

}  // namespace skerry::mesh
