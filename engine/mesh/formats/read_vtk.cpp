#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "engine/mesh/formats/vtk_cells.h"

// Reader of legacy VTK files. Format: "VTK File Formats", VTK user's guide. Since file version 5.1, a section of cells
// has two separate lists, OFFSETS and CONNECTIVITY.
namespace skerry::mesh {
namespace {

class VtkReader {
public:
    explicit VtkReader(FileReader& reader) : reader_(reader) {}

    RawMesh read() {
        read_header();
        bool more = true;
        while (more && !reader_.at_end()) more = read_section(std::string(reader_.word("a section")));
        reader_.set_section({});
        if (!has_points_) reader_.complain({}, "no section of points", "a section POINTS");
        if (dataset_ == "UNSTRUCTURED_GRID") {
            if (!has_cells_) reader_.complain({}, "no section of cells", "a section CELLS");
            if (!has_types_) reader_.complain({}, "no section of cell types", "a section CELL_TYPES");
            reader_.set_section("CELLS");
            take_vtk_cells(cells_, reader_, mesh_);
            take_vtk_sets(cells_, mesh_);
        }
        return std::move(mesh_);
    }

private:
    void read_header() {
        reader_.set_section("header");
        const std::string_view magic = reader_.filled_line("# vtk DataFile Version");
        if (!magic.starts_with("# vtk DataFile Version"))
            reader_.complain({}, in_quotes(magic), "a first line that begins with # vtk DataFile Version",
                             "save the mesh as a legacy VTK file; other VTK formats are not supported");
        reader_.line();  // title
        const std::string_view format = reader_.filled_line("ASCII or BINARY");
        if (format != "ASCII" && format != "BINARY") reader_.complain("format", in_quotes(format), "ASCII or BINARY");
        binary_ = format == "BINARY";
        reader_.set_binary(binary_);
        reader_.set_swapped_bytes(std::endian::native == std::endian::little);  // binary VTK files are big-endian
        const std::string_view key = reader_.word("DATASET");
        if (key != "DATASET") reader_.complain({}, in_quotes(key), "DATASET");
        dataset_ = reader_.word("the type of the data set");
        if (dataset_ != "UNSTRUCTURED_GRID" && dataset_ != "POLYDATA")
            reader_.complain("DATASET", in_quotes(dataset_), "UNSTRUCTURED_GRID or POLYDATA");
    }

    /// Reads the section with the given name. Returns false if the rest of the file contains no mesh data.
    bool read_section(const std::string& name) {
        reader_.set_section(name);
        if (name == "POINT_DATA" || name == "CELL_DATA") return read_data(name == "CELL_DATA");
        if (name == "POINTS")
            read_points();
        else if (name == "CELLS" && dataset_ == "UNSTRUCTURED_GRID")
            read_cells(has_cells_);
        else if (name == "CELL_TYPES" && dataset_ == "UNSTRUCTURED_GRID")
            read_types();
        else if (name == "POLYGONS" && dataset_ == "POLYDATA")
            read_polygons();
        else if ((name == "VERTICES" || name == "LINES" || name == "TRIANGLE_STRIPS") && dataset_ == "POLYDATA")
            skip_polydata(name == "VERTICES" ? "points" : name == "LINES" ? "lines" : "triangle strips");
        else if (name == "FIELD")
            skip_field();
        else if (name == "METADATA")
            skip_metadata();
        else
            reader_.complain({}, in_quotes(name),
                             "a section POINTS, CELLS, CELL_TYPES, POLYGONS, FIELD, METADATA, CELL_DATA or POINT_DATA");
        return true;
    }

    /// Skips lines up to an empty line or the end of the file.
    void skip_metadata() {
        reader_.line();  // skips the rest of the line with the keyword
        while (reader_.remaining() > 0 && !reader_.line().empty()) {
        }
    }

    std::size_t read_count(const char* field, std::size_t bytes) {
        return reader_.checked_count(reader_.parse_integer(reader_.word(field), field), bytes, field);
    }

    NumberType read_type(const char* field) {
        const std::string name(reader_.word(field));
        const std::optional<NumberType> type = type_of(name);
        if (!type) reader_.complain(field, in_quotes(name), "a number type of VTK, for example float or double");
        return *type;
    }

    static std::optional<NumberType> type_of(std::string_view name) {
        const std::string lower = in_lower_case(name);
        struct Name {
            const char* name;
            NumberType type;
        };
        static constexpr std::array<Name, 14> names{{{"float", {NumberKind::float32, 4}},
                                                     {"bit", {NumberKind::bit, 1}},
                                                     {"double", {NumberKind::float64, 8}},
                                                     {"int", {NumberKind::int32, 4}},
                                                     {"unsigned_int", {NumberKind::uint32, 4}},
                                                     {"long", {NumberKind::int64, 8}},
                                                     {"unsigned_long", {NumberKind::uint64, 8}},
                                                     {"vtktypeint64", {NumberKind::int64, 8}},
                                                     {"vtkidtype", {NumberKind::int32, 4}},
                                                     {"char", {NumberKind::int8, 1}},
                                                     {"unsigned_char", {NumberKind::uint8, 1}},
                                                     {"short", {NumberKind::int16, 2}},
                                                     {"unsigned_short", {NumberKind::uint16, 2}},
                                                     {"vtktypeint32", {NumberKind::int32, 4}}}};
        const auto found = std::find_if(names.begin(), names.end(), [&](const Name& n) { return lower == n.name; });
        if (found == names.end()) return {};
        return found->type;
    }

    /// Skips the line end between the counts and the rows of binary data. In text files, word() skips it.
    void begin_rows() {
        if (binary_) reader_.line();
    }

    void read_points() {
        if (has_points_) reader_.complain({}, "a second section POINTS", "only one section POINTS");
        has_points_ = true;
        const std::size_t count = read_count("count", binary_ ? 3 : 6);
        const NumberType type = read_type("type");
        begin_rows();
        mesh_.nodes.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            reader_.set_row("point", i + 1, count);
            Vec3 x;
            for (Real& value : x) value = reader_.finite(reader_.real(type, "position"), "position");
            mesh_.nodes.push_back(x);
        }
    }

    Index read_node(const NumberType& type) {
        const std::int64_t node = reader_.integer(type, "node");
        if (node < 0 || node >= static_cast<std::int64_t>(mesh_.nodes.size()))
            reader_.complain(
                "node", std::to_string(node),
                "the index of a point, 0 to " + std::to_string(static_cast<std::int64_t>(mesh_.nodes.size()) - 1));
        return static_cast<Index>(node);
    }

    /// Reads the nodes of the cells in section CELLS or POLYGONS. Before file version 5.1, each cell has its node
    /// count, followed by its nodes. Since 5.1, the offsets of all cells come first, then all nodes.
    void read_cells(bool& has_rows) {
        if (!has_points_)
            reader_.complain({}, "cells before the points", "the section POINTS before the sections of cells");
        if (std::exchange(has_rows, true)) reader_.complain({}, "a second section of cells of the same name", "one");
        const std::size_t first = read_count("count", 1), second = read_count("size", 1);
        reader_.peek_word() == "OFFSETS" ? read_new_cells(first, second) : read_old_cells(first, second);
    }

    void read_old_cells(std::size_t cells, std::size_t size) {
        constexpr NumberType type{NumberKind::int32, 4};
        reader_.checked_count(static_cast<std::int64_t>(size), binary_ ? 4 : 2, "size");
        begin_rows();
        cells_.offset.assign(1, 0);
        for (std::size_t c = 0; c < cells; ++c) {
            reader_.set_row("cell", c + 1, cells);
            const std::int64_t nodes = reader_.integer(type, "node count");
            // Number of integers that are left in the section according to `size` in its header. So far the node counts
            // of the cells 0 to c and the nodes of the cells 0 to c - 1 have been read.
            const std::size_t remaining = size - std::min(size, cells_.offset.back() + c + 1);
            if (nodes < 0 || static_cast<std::uint64_t>(nodes) > remaining)
                reader_.complain(
                    "node count", std::to_string(nodes), "at most " + std::to_string(remaining),
                    "only that many entries remain of the size in the header of this section; correct this size or the "
                    "node count of the cell");
            for (std::int64_t a = 0; a < nodes; ++a) cells_.node.push_back(read_node(type));
            cells_.offset.push_back(cells_.offset.back() + static_cast<std::size_t>(nodes));
        }
        if (cells_.offset.back() + cells != size)
            reader_.complain(
                "size", std::to_string(size) + " in the header", std::to_string(cells_.offset.back() + cells),
                "the cells have that many entries: a node count and the nodes of each; correct the header");
    }

    void read_new_cells(std::size_t offsets, std::size_t size) {
        reader_.word("OFFSETS");
        const NumberType offset_type = read_type("type of OFFSETS");
        begin_rows();
        reader_.checked_count(static_cast<std::int64_t>(offsets), binary_ ? offset_type.size : 2, "count");
        cells_.offset.clear();
        for (std::size_t i = 0; i < offsets; ++i) {
            reader_.set_row("offset", i + 1, offsets);
            const std::int64_t offset = reader_.integer(offset_type, "offset");
            const std::int64_t least = cells_.offset.empty() ? 0 : static_cast<std::int64_t>(cells_.offset.back());
            if (offset < least || offset > static_cast<std::int64_t>(size) || (cells_.offset.empty() && offset != 0))
                reader_.complain("offset", std::to_string(offset),
                                 cells_.offset.empty() ? "0"
                                                       : std::to_string(least) + " to " + std::to_string(size) +
                                                             ", because offsets ascend to the size of CONNECTIVITY");
            cells_.offset.push_back(static_cast<std::size_t>(offset));
        }
        if (cells_.offset.empty()) cells_.offset.push_back(0);
        reader_.set_section("CONNECTIVITY");
        if (cells_.offset.back() != size)
            reader_.complain("last offset", std::to_string(cells_.offset.back()),
                             std::to_string(size) + ", the size of CONNECTIVITY");
        if (const std::string_view key = reader_.word("CONNECTIVITY"); key != "CONNECTIVITY")
            reader_.complain({}, in_quotes(key), "CONNECTIVITY");
        const NumberType node_type = read_type("type");
        begin_rows();
        for (std::size_t i = 0; i < size; ++i) {
            reader_.set_row("entry", i + 1, size);
            cells_.node.push_back(read_node(node_type));
        }
    }

    void read_types() {
        if (!has_cells_) reader_.complain({}, "cell types before the cells", "the section CELLS before CELL_TYPES");
        if (std::exchange(has_types_, true))
            reader_.complain({}, "a second section CELL_TYPES", "only one section CELL_TYPES");
        const std::size_t count = read_count("count", binary_ ? 4 : 2);
        if (count + 1 != cells_.offset.size())
            reader_.complain("count", std::to_string(count),
                             std::to_string(cells_.offset.size() - 1) + ", the number of cells");
        begin_rows();
        for (std::size_t i = 0; i < count; ++i) {
            reader_.set_row("cell", i + 1, count);
            cells_.type.push_back(reader_.integer({NumberKind::int32, 4}, "type"));
        }
    }

    void read_polygons() {
        read_cells(has_cells_);
        for (std::size_t c = 0; c + 1 < cells_.offset.size(); ++c) {
            reader_.set_row("polygon", c + 1, cells_.offset.size() - 1);
            add_polygon(std::span(cells_.node).subspan(cells_.offset[c], cells_.offset[c + 1] - cells_.offset[c]),
                        reader_, mesh_);
        }
        cells_.node.clear();
        cells_.offset.assign(1, 0);
    }

    void skip_polydata(const char* kind) {
        bool ignored = false;
        read_cells(ignored);
        mesh_.others[kind] += cells_.offset.size() - 1;
        cells_.node.clear();
        cells_.offset.assign(1, 0);
    }

    /// Reads the data arrays of points or cells; read_array() decides which of them are stored. Returns true if another
    /// section of data follows. Returns false if no mesh data can follow: at the end of the file, or at unknown
    /// content.
    bool read_data(bool of_cells) {
        if (dataset_ == "POLYDATA") return false;
        const std::size_t rows = of_cells ? cells_.type.size() : mesh_.nodes.size();
        if (const std::int64_t count = reader_.parse_integer(reader_.word("count"), "count");
            count != static_cast<std::int64_t>(rows))
            reader_.complain("count", std::to_string(count),
                             std::to_string(rows) + (of_cells ? ", the number of cells" : ", the number of points"));
        while (!reader_.at_end()) {
            const std::string_view next = reader_.peek_word();
            if (next == "POINT_DATA" || next == "CELL_DATA") return true;
            if (!read_attribute(std::string(reader_.word("an array")), rows, of_cells)) return false;
        }
        return false;
    }

    /// Reads one array, or a field of several arrays, according to the keyword before it. Returns false for an unknown
    /// keyword or type.
    bool read_attribute(const std::string& keyword, std::size_t rows, bool of_cells) {
        reader_.set_section(keyword);
        if (keyword == "METADATA") {
            skip_metadata();
            return true;
        }
        const std::string name(reader_.word("the name of the array"));
        if (keyword == "FIELD") return read_field_data(rows, of_cells);
        if (keyword == "COLOR_SCALARS" || keyword == "LOOKUP_TABLE") {
            const std::size_t count = read_count("count", 1);
            // A value is a byte in a binary file, and a word in a text file. There a colour component is a fraction
            // such as 0.5, which does not matter, because skip_array() does not interpret the words.
            return skip_array(keyword == "LOOKUP_TABLE" ? count : rows, keyword == "LOOKUP_TABLE" ? 4 : count,
                              {NumberKind::uint8, 1});
        }
        const std::size_t coordinates = keyword == "TEXTURE_COORDINATES" ? read_count("dimension", 1) : 0;
        const std::optional<NumberType> type = type_of(reader_.word("type"));
        if (!type) return false;
        if (keyword == "SCALARS") return read_scalars(name, rows, of_cells, *type);
        if (keyword == "TEXTURE_COORDINATES") return skip_array(rows, coordinates, *type);
        if (keyword == "VECTORS" || keyword == "NORMALS") {
            begin_rows();
            return read_array(name, rows, 3, of_cells, *type);
        }
        if (keyword == "TENSORS") return skip_array(rows, 9, *type);
        if (keyword == "TENSORS6") return skip_array(rows, 6, *type);
        if (keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS" || keyword == "EDGE_FLAGS")
            return skip_array(rows, 1, *type);
        return false;
    }

    /// Reads an array whose "SCALARS name type" has been read. A component count and a LOOKUP_TABLE line may come next.
    bool read_scalars(const std::string& name, std::size_t rows, bool of_cells, const NumberType& type) {
        std::size_t components = 1;
        if (const std::string_view rest = reader_.line(); !rest.empty())
            components = reader_.checked_count(reader_.parse_integer(rest, "components"), 1, "components");
        if (reader_.peek_word() == "LOOKUP_TABLE") {
            reader_.word("LOOKUP_TABLE");
            reader_.word("the name of the table");
            begin_rows();
        }
        return read_array(name, rows, components, of_cells, type);
    }

    bool read_field_data(std::size_t data_rows, bool of_cells) {
        const std::size_t arrays = read_count("arrays", 4);
        for (std::size_t i = 0; i < arrays; ++i) {
            reader_.set_row("array", i + 1, arrays);
            const std::string name(reader_.word("the name of the array"));
            if (name == "METADATA") {  // METADATA describes the previous array and is not counted in `arrays`
                skip_metadata();
                --i;
                continue;
            }
            const std::size_t components = read_count("components", 1), rows = read_count("rows", 1);
            const std::optional<NumberType> type = type_of(reader_.word("type"));
            if (!type) return false;
            begin_rows();
            if (rows == data_rows)
                read_array(name, rows, components, of_cells, *type);
            else
                skip_rows(rows, components, *type);
        }
        return true;
    }

    bool read_vectors(const std::string& name, std::size_t rows, const NumberType& type) {
        std::vector<Vec3>& vectors = cells_.vectors[name];
        vectors.clear();
        for (std::size_t i = 0; i < rows; ++i) {
            reader_.set_row("cell", i + 1, rows);
            Vec3& vector = vectors.emplace_back();
            for (Real& entry : vector) entry = reader_.real(type, "vector");
        }
        return true;
    }

    /// Stores three kinds of arrays and skips all others: the first array of cell labels, arrays of one whole number
    /// per row, and arrays of one vector per cell.
    bool read_array(const std::string& name, std::size_t rows, std::size_t components, bool of_cells,
                    const NumberType& type) {
        const bool labels = of_cells && cells_.label.empty() && is_vtk_label(name);
        const bool real = type.is_real();
        if (of_cells && components == 3 && type.kind != NumberKind::bit) return read_vectors(name, rows, type);
        if (components != 1 || (real && !labels)) return skip_rows(rows, components, type);
        std::vector<int> numbers;
        bool whole = true;
        unsigned bits = 0;  // byte with eight values, the first of them in the highest bit
        for (std::size_t i = 0; i < rows; ++i) {
            reader_.set_row(of_cells ? "cell" : "point", i + 1, rows);
            std::optional<int> number;
            if (binary_ && type.kind == NumberKind::bit) {
                if (i % 8 == 0) bits = reader_.binary<std::uint8_t>("bits");
                number = static_cast<int>(bits >> (7 - i % 8) & 1u);
            } else {
                number = as_label(reader_.real(type, labels ? "label" : "number"));
            }
            whole = whole && number;
            numbers.push_back(number.value_or(0));
        }
        if (whole && labels)
            cells_.label = std::move(numbers);
        else if (whole && !is_vtk_label(name))
            (of_cells ? cells_.cell_data : cells_.point_data).push_back({name, std::move(numbers)});
        return true;
    }

    bool skip_array(std::size_t rows, std::size_t components, const NumberType& type) {
        begin_rows();
        return skip_rows(rows, components, type);
    }

    bool skip_rows(std::size_t rows, std::size_t components, const NumberType& type) {
        const bool bits = binary_ && type.kind == NumberKind::bit;
        const std::size_t count = bits ? (components * rows + 7) / 8 : components * rows;
        const std::size_t numbers =
            reader_.checked_count(static_cast<std::int64_t>(count), binary_ ? type.size : 2, "numbers");
        if (binary_)
            reader_.skip_bytes(numbers * type.size, "numbers");
        else
            for (std::size_t n = 0; n < numbers; ++n) reader_.word("a number");
        return true;
    }

    /// Skips "FIELD name arrays", where each array has the form "name components rows type", followed by its numbers.
    void skip_field() {
        reader_.word("the name of the field");
        const std::size_t arrays = read_count("arrays", 4);
        for (std::size_t i = 0; i < arrays; ++i) {
            reader_.set_row("array", i + 1, arrays);
            reader_.word("the name of the array");
            const std::size_t components = read_count("components", 1), rows = read_count("rows", 1);
            const NumberType type = read_type("type");
            skip_array(rows, components, type);
        }
    }

    FileReader& reader_;
    std::string dataset_;
    bool binary_ = false, has_points_ = false, has_cells_ = false, has_types_ = false;
    VtkCells cells_;
    RawMesh mesh_;
};

}  // namespace

RawMesh read_vtk(FileReader& reader) {
    return VtkReader(reader).read();
}

}  // namespace skerry::mesh
