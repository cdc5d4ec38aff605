#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "engine/mesh/formats/vtk_cells.h"
#include "engine/mesh/formats/vtk_xml.h"

// Reader of VTK XML files with unstructured grids. A general XML parser is not used, because a file with raw binary
// data in <AppendedData> is not valid XML.
namespace skerry::mesh {
namespace {

struct Piece {
    XmlTag tag;
    std::optional<VtkXmlArray> points{};
    std::map<std::string, VtkXmlArray, std::less<>> cells{};
    std::vector<VtkXmlArray> cell_data{}, point_data{};
};

class VtuReader {
public:
    explicit VtuReader(FileReader& reader) : reader_(reader) {}

    RawMesh read() {
        read_tags();
        for (std::size_t p = 0; p < pieces_.size(); ++p) take_piece(pieces_[p], named(p));
        if (cells_.label.size() != cells_.type.size()) cells_.label.clear();
        reader_.go_to(0);
        reader_.set_section("<Cells>");
        take_vtk_cells(cells_, reader_, mesh_);
        take_vtk_sets(cells_, mesh_);
        return std::move(mesh_);
    }

private:
    static std::string named(std::size_t piece) { return "<Piece> " + std::to_string(piece + 1); }

    void read_tags() {
        const XmlTag file = next_tag(reader_);
        if (file.name != "VTKFile") complain(file, {}, "the tag " + in_quotes(file.name), "<VTKFile ...>");
        read_form(file);
        // name of the tag around the next arrays: Points, Cells, CellData, PointData or FieldData
        std::string section;
        while (true) {
            const XmlTag tag = next_tag(reader_);
            if (tag.name == "VTKFile" && !tag.opens) break;
            if (tag.name == "AppendedData") {
                read_appended(tag);
                break;
            }
            if (tag.name == "Piece" && tag.opens) {
                pieces_.push_back({tag});
            } else if (tag.name == "DataArray" && tag.opens) {
                take_array(tag, section);
            } else if (tag.name == "Points" || tag.name == "Cells" || tag.name == "CellData" ||
                       tag.name == "PointData" || tag.name == "FieldData") {
                section = tag.opens && !tag.closes ? std::string(tag.name) : std::string();
            }
        }
        if (pieces_.empty()) complain(file, {}, "no <Piece>", "at least one <Piece> in <UnstructuredGrid>");
    }

    void read_form(const XmlTag& file) {
        const std::string_view type = file.value_of("type"), order = file.value_of("byte_order", "LittleEndian"),
                               header = file.value_of("header_type", "UInt32"), packer = file.value_of("compressor");
        if (type != "UnstructuredGrid")
            complain(file, "type", in_quotes(type), "\"UnstructuredGrid\"", "save the mesh as an unstructured grid");
        if (order != "LittleEndian" && order != "BigEndian")
            complain(file, "byte_order", in_quotes(order), "LittleEndian or BigEndian");
        if (header != "UInt32" && header != "UInt64")
            complain(file, "header_type", in_quotes(header), "UInt32 or UInt64");
        if (!packer.empty() && packer != "vtkZLibDataCompressor")
            complain(file, "compressor", in_quotes(packer), "vtkZLibDataCompressor, or no compressor",
                     "save the mesh without compression, or with zlib");
        form_.swapped_bytes = (order == "LittleEndian") != (std::endian::native == std::endian::little);
        form_.wide_header = header == "UInt64";
        form_.compressed = !packer.empty();
    }

    void take_array(const XmlTag& tag, const std::string& section) {
        VtkXmlArray array{tag, {}, {}};
        if (!tag.closes) {
            const std::string_view bytes = bytes_of(reader_);
            const std::size_t end = std::min(bytes.find('<', tag.end), bytes.size());
            array.text = bytes.substr(tag.end, end - tag.end);
        }
        if (pieces_.empty()) return;
        Piece& piece = pieces_.back();
        const std::string name(tag.value_of("Name"));
        array.section = named(pieces_.size() - 1) + ", <" + section + ">, array " + in_quotes(name);
        if (section == "Points")
            piece.points = array;
        else if (section == "Cells")
            piece.cells.insert_or_assign(name, array);
        else if (section == "CellData")
            piece.cell_data.push_back(array);
        else if (section == "PointData")
            piece.point_data.push_back(array);
    }

    void read_appended(const XmlTag& tag) {
        const std::string_view encoding = tag.value_of("encoding", "base64");
        if (encoding != "raw" && encoding != "base64") complain(tag, "encoding", in_quotes(encoding), "raw or base64");
        const std::string_view bytes = bytes_of(reader_);
        const std::size_t start = bytes.find('_', tag.end);
        if (start == std::string_view::npos)
            complain(tag, {}, "no _ before the data", "an underscore before the data", "export the file again");
        form_.has_appended = true;
        form_.appended_base64 = encoding == "base64";
        form_.appended = bytes.substr(start + 1);
        if (form_.appended_base64) form_.appended = form_.appended.substr(0, form_.appended.find('<'));
    }

    std::size_t count_of(const Piece& piece, const char* attribute) {
        constexpr std::int64_t most = std::numeric_limits<Index>::max() / 4;
        reader_.go_to(piece.tag.place);
        const std::int64_t count = reader_.parse_integer(piece.tag.value_of(attribute), attribute);
        if (count < 0 || count > most)
            reader_.complain(attribute, std::to_string(count), "0 to " + std::to_string(most));
        return static_cast<std::size_t>(count);
    }

    const VtkXmlArray& array_of(const Piece& piece, const std::string& piece_name, const char* name) {
        const auto found = piece.cells.find(name);
        if (found == piece.cells.end())
            complain(piece.tag, piece_name + ", <Cells>", std::string("no array \"") + name + "\"",
                     "the arrays connectivity, offsets and types");
        return found->second;
    }

    void take_piece(const Piece& piece, const std::string& name) {
        reader_.set_section(name);
        const std::size_t points = count_of(piece, "NumberOfPoints"), cells = count_of(piece, "NumberOfCells");
        const std::size_t first_node = mesh_.nodes.size(), first_cell = cells_.type.size();
        if (first_node + points > static_cast<std::size_t>(std::numeric_limits<Index>::max() / 4))
            complain(piece.tag, "NumberOfPoints", std::to_string(first_node + points) + " points in all pieces",
                     "at most " + std::to_string(std::numeric_limits<Index>::max() / 4));
        take_points(piece, name, points);
        take_offsets(array_of(piece, name, "offsets"), cells);
        take_nodes(array_of(piece, name, "connectivity"), first_node);
        const std::vector<std::int64_t> types =
            integers_of(array_of(piece, name, "types"), form_, cells, "type", reader_);
        cells_.type.insert(cells_.type.end(), types.begin(), types.end());
        if (cells_.label.size() == first_cell) take_labels(piece, cells);
        take_data(piece.point_data, points, first_node, cells_.point_data);
        take_data(piece.cell_data, cells, first_cell, cells_.cell_data);
        take_vectors(piece, cells, first_cell);
    }

    void take_points(const Piece& piece, const std::string& name, std::size_t count) {
        if (!piece.points) complain(piece.tag, name, "no array in <Points>", "the positions of the points");
        const std::string_view components = piece.points->tag.value_of("NumberOfComponents", "3");
        if (components != "3")
            complain(piece.points->tag, "NumberOfComponents", in_quotes(components), "\"3\" (x, y and z)");
        const std::vector<Real> numbers = reals_of(*piece.points, form_, 3 * count, "position", reader_);
        for (std::size_t n = 0; n < count; ++n) {
            reader_.set_row("point", n + 1, count);
            Vec3 x;
            for (std::size_t a = 0; a < 3; ++a)
                x[static_cast<Eigen::Index>(a)] = reader_.finite(numbers[3 * n + a], "position");
            mesh_.nodes.push_back(x);
        }
    }

    void take_offsets(const VtkXmlArray& array, std::size_t count) {
        const std::vector<std::int64_t> offsets = integers_of(array, form_, count, "offset", reader_);
        const std::size_t before = cells_.offset.back();
        std::int64_t last = 0;
        for (std::size_t c = 0; c < count; ++c) {
            reader_.set_row("cell", c + 1, count);
            if (offsets[c] < last || offsets[c] > std::numeric_limits<Index>::max())
                reader_.complain("offset", std::to_string(offsets[c]),
                                 "at least " + std::to_string(last) + ", because offsets ascend");
            last = offsets[c];
            cells_.offset.push_back(before + static_cast<std::size_t>(last));
        }
    }

    void take_nodes(const VtkXmlArray& array, std::size_t first_node) {
        const std::size_t count = cells_.offset.back() - cells_.node.size();
        const auto points = static_cast<std::int64_t>(mesh_.nodes.size() - first_node);
        const std::vector<std::int64_t> nodes = integers_of(array, form_, count, "node", reader_);
        for (std::size_t i = 0; i < count; ++i) {
            if (nodes[i] < 0 || nodes[i] >= points) {
                reader_.set_row("entry", i + 1, count);
                reader_.complain("node", std::to_string(nodes[i]),
                                 "the index of a point, 0 to " + std::to_string(points - 1));
            }
            cells_.node.push_back(static_cast<Index>(first_node + static_cast<std::size_t>(nodes[i])));
        }
    }

    /// Adds the labels of the cells of a piece. Uses the first array that is named like labels and has only whole
    /// numbers.
    void take_labels(const Piece& piece, std::size_t count) {
        for (const VtkXmlArray& array : piece.cell_data) {
            const std::string_view components = array.tag.value_of("NumberOfComponents", "1");
            if (!is_vtk_label(array.tag.value_of("Name")) || (components != "1" && !components.empty())) continue;
            std::vector<int> labels;
            for (const Real number : reals_of(array, form_, count, "label", reader_))
                if (const std::optional<int> label = as_label(number)) labels.push_back(*label);
            if (labels.size() != count) continue;
            cells_.label.insert(cells_.label.end(), labels.begin(), labels.end());
            return;
        }
    }

    /// Appends each array of whole numbers of a piece to the array of the same name in `all`. `before`: number of
    /// points or cells of earlier pieces. Ignores an array that an earlier piece lacks, because it would have no values
    /// there.
    void take_data(const std::vector<VtkXmlArray>& arrays, std::size_t count, std::size_t before,
                   std::vector<VtkArray>& all) {
        for (const VtkXmlArray& array : arrays) {
            const std::string name(array.tag.value_of("Name"));
            const std::string_view type = array.tag.value_of("type"),
                                   components = array.tag.value_of("NumberOfComponents", "1");
            const bool whole = type.starts_with("Int") || type.starts_with("UInt");
            if (!whole || (components != "1" && !components.empty()) || is_vtk_label(name)) continue;
            auto known = std::ranges::find(all, name, &VtkArray::name);
            if (known == all.end() && before == 0) known = all.insert(all.end(), {name, {}});
            if (known == all.end() || known->value.size() != before) continue;
            for (const Real number : reals_of(array, form_, count, "number", reader_))
                if (const std::optional<int> value = as_label(number)) known->value.push_back(*value);
        }
    }

    /// Appends the vectors of the cells of a piece to cells_.vectors. `before`: number of cells of earlier pieces.
    /// Ignores an array that an earlier piece lacks, because it would have no values there.
    void take_vectors(const Piece& piece, std::size_t count, std::size_t before) {
        for (const VtkXmlArray& array : piece.cell_data) {
            if (array.tag.value_of("NumberOfComponents", "1") != "3") continue;
            std::vector<Vec3>& vectors = cells_.vectors[std::string(array.tag.value_of("Name"))];
            if (vectors.size() != before) continue;
            const auto numbers = reals_of(array, form_, 3 * count, "vector", reader_);
            for (std::size_t c = 0; c < count; ++c)
                vectors.emplace_back(numbers[3 * c], numbers[3 * c + 1], numbers[3 * c + 2]);
        }
    }

    [[noreturn]] void complain(const XmlTag& at, const std::string& field, const std::string& found,
                               const std::string& expected, const std::string& hint = {}) {
        reader_.go_to(at.place);
        reader_.set_section("<" + std::string(at.name) + ">");
        reader_.complain(field, found, expected, hint);
    }

    FileReader& reader_;
    VtkXmlForm form_;
    std::vector<Piece> pieces_;
    VtkCells cells_;
    RawMesh mesh_;
};

}  // namespace

RawMesh read_vtu(FileReader& reader) {
    return VtuReader(reader).read();
}

}  // namespace skerry::mesh
