#include "engine/output/vtk/vtk_file.h"

#include <array>
#include <charconv>
#include <ostream>

#include "components/check.h"
#include "engine/base/write_file.h"

namespace skerry {

std::string number_text(double value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

VtkFile::VtkFile(std::string_view kind, Real time, std::initializer_list<VtkTexts> texts) : kind_(kind) {
    tags_ = "<?xml version=\"1.0\"?>\n";
    open("VTKFile", "type=\"" + kind_ + "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"");
    open(kind_);
    tags_ += "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">" +
             number_text(time) + "</DataArray>\n";
    // VTK encodes texts as decimal character codes, and ends each text with a zero.
    for (const auto& [name, strings] : texts) {
        tags_.append("<Array type=\"String\" Name=\"").append(name).append("\" NumberOfTuples=\"");
        tags_.append(std::to_string(strings.size())).append("\" format=\"ascii\">");
        for (const std::string& text : strings) {
            for (const char c : text) tags_.append(std::to_string(static_cast<unsigned char>(c))).append(" ");
            tags_.append("0 ");
        }
        tags_ += "</Array>\n";
    }
    tags_ += "</FieldData>\n";
}

void VtkFile::open(std::string_view tag, std::string_view attributes) {
    tags_.append("<").append(tag);
    if (!attributes.empty()) tags_.append(" ").append(attributes);
    tags_.append(">\n");
}

void VtkFile::close(std::string_view tag) {
    tags_.append("</").append(tag).append(">\n");
}

void VtkFile::begin_array(std::string_view type, std::string_view name, int components) {
    tags_.append("<DataArray type=\"").append(type).append("\" Name=\"").append(name);
    tags_.append("\" NumberOfComponents=\"").append(std::to_string(components));
    tags_.append("\" format=\"appended\" offset=\"").append(std::to_string(data_.size())).append("\"/>\n");
}

void VtkFile::check_size([[maybe_unused]] std::size_t expected) const {
    SKERRY_CHECK(data_.size() == expected);
}

void VtkFile::write(const std::filesystem::path& file) {
    close(kind_);
    tags_ += "<AppendedData encoding=\"raw\">_";
    write_file(file, [&](std::ostream& out) {
        out << tags_ << data_ << "\n</AppendedData>\n</VTKFile>\n";
    });  // meshio expects the line end between data and </AppendedData>
}

}  // namespace skerry
