#include "tests/ranks/first_difference.h"

#include <array>
#include <cstdio>
#include <cstring>

#include "components/any_table.h"
#include "engine/world/edit/row_moves.h"

namespace skerry::test {

namespace {

struct RowsOfTable {
    AnyTable table;
    Range rows;
};

/// Tables with state of a body, and the rows of the body in them.
std::array<RowsOfTable, 8> tables_of(Model& model, std::size_t body) {
    const OfBodyTables<Range> rows = rows_of_body(model, body);
    return {{{{model.nodes, "nodes"}, rows.nodes},
             {{model.rigid_bodies, "rigid_bodies"}, rows.rigid},
             {{model.implicit_nodes, "implicit_nodes"}, rows.implicit},
             {{model.node_blocks, "node_blocks"}, rows.node_blocks},
             {{model.elements, "elements"}, rows.blocks},
             {{model.element_nodes, "element_nodes"}, rows.element_nodes},
             {{model.tetrahedra, "tetrahedra"}, rows.tetrahedron_blocks},
             {{model.bodies, "bodies"}, rows.bodies}}};
}

/// The number of a row at `byte`, or for other types than reals the byte itself.
std::string value_at(const RowType& type, const std::byte* row, std::size_t byte) {
    char text[64];
    if (type.width > 0 && type.number == NumberType::real) {
        double value = 0;
        std::memcpy(&value, row + byte / sizeof value * sizeof value, sizeof value);
        std::snprintf(text, sizeof text, "%.17g", value);
    } else {
        std::snprintf(text, sizeof text, "byte %zu: %d", byte, std::to_integer<int>(row[byte]));
    }
    return text;
}

std::string difference_of_columns(AnyColumn expected, Range rows, AnyColumn found, Range same_rows) {
    const RowType& type = expected.type();
    for (Index i = 0; i < rows.size(); ++i) {
        const std::byte *a = expected.read() + static_cast<std::size_t>(rows.begin + i) * type.bytes,
                        *b = found.read() + static_cast<std::size_t>(same_rows.begin + i) * type.bytes;
        for (std::size_t byte = 0; byte < type.bytes; ++byte)
            if (a[byte] != b[byte])
                return "row " + std::to_string(i) + ": expected " + value_at(type, a, byte) + ", found " +
                       value_at(type, b, byte);
    }
    return {};
}

}  // namespace

std::string first_difference(Model& expected, std::size_t body, Model& found, std::size_t same_body) {
    const auto tables = tables_of(expected, body), same_tables = tables_of(found, same_body);
    for (std::size_t t = 0; t < tables.size(); ++t) {
        const auto& [table, rows] = tables[t];
        const auto& [same_table, same_rows] = same_tables[t];
        const std::string name = table.name();
        if (rows.size() != same_rows.size())
            return name + ": expected " + std::to_string(rows.size()) + " rows, found " +
                   std::to_string(same_rows.size());
        for (const ColumnInfo& info : table.columns()) {
            if (info.role != ColumnRole::state || !info.has_row_each) continue;
            const std::string difference =
                difference_of_columns(table.column(info), rows, same_table.column(info), same_rows);
            if (!difference.empty()) return name + "." + info.name + ", " + difference;
        }
    }
    return {};
}

}  // namespace skerry::test
