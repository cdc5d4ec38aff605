#include "components/any_table.h"

#include <vector>

#include "components/attachment_table.h"
#include "components/body_table.h"
#include "components/bvh_table.h"
#include "components/cable_table.h"
#include "components/cavity_table.h"
#include "components/collider_table.h"
#include "components/collision_filter.h"
#include "components/contact_table.h"
#include "components/element_table.h"
#include "components/fibre_table.h"
#include "components/implicit_node_table.h"
#include "components/joint_table.h"
#include "components/load_table.h"
#include "components/material_table.h"
#include "components/node_block_table.h"
#include "components/node_table.h"
#include "components/pair_table.h"
#include "components/region_table.h"
#include "components/resting_contact_table.h"
#include "components/rigid_body_table.h"
#include "components/spring_table.h"
#include "components/surface_rules.h"
#include "components/surface_table.h"
#include "components/tie_table.h"

namespace skerry {

void AnyColumn::resize(std::size_t count) const {
    RowMemory& memory = changed();
    const std::size_t before = memory.size();
    if (count > before) {
        memory.make_room(count - before, type_->bytes);
        type_->make(static_cast<std::byte*>(memory.rows()) + before * type_->bytes, count - before);
    }
    memory.set_size(count);
}

void AnyTable::resize(std::size_t rows) const {
    for (const ColumnInfo& info : columns_)
        if (info.has_row_each) column(info).resize(rows);
}

void AnyTable::erase(std::span<const Range> erased) const {
    for (const ColumnInfo& info : columns_)
        if (info.has_row_each) column(info).erase(erased);
}

template <class Table>
std::span<const ColumnInfo> columns_of() {
    static const std::vector<ColumnInfo> list = [] {
        Table table;
        std::vector<ColumnInfo> columns;
        const auto add = [&]<class T>(const char* name, const Column<T>& column, ColumnRole role) {
            const auto offset = reinterpret_cast<const std::byte*>(&column) - reinterpret_cast<std::byte*>(&table);
            columns.push_back({name, role, true, static_cast<std::size_t>(offset), &row_type<T>});
        };
        if constexpr (requires { table.for_each_row_column(add); }) table.for_each_row_column(add);
        if constexpr (requires { table.for_each_column(add); }) {
            const std::size_t with_row_each = columns.size();
            columns.clear();
            table.for_each_column(add);
            if (with_row_each > 0)
                for (std::size_t c = with_row_each; c < columns.size(); ++c) columns[c].has_row_each = false;
        }
        return columns;
    }();
    return list;
}

template std::span<const ColumnInfo> columns_of<AttachmentTable>();
template std::span<const ColumnInfo> columns_of<BodyTable>();
template std::span<const ColumnInfo> columns_of<BvhLeafTable>();
template std::span<const ColumnInfo> columns_of<BvhTable>();
template std::span<const ColumnInfo> columns_of<CableBlockTable>();
template std::span<const ColumnInfo> columns_of<CableTable>();
template std::span<const ColumnInfo> columns_of<CavityTable>();
template std::span<const ColumnInfo> columns_of<ColliderTable>();
template std::span<const ColumnInfo> columns_of<ContactTable>();
template std::span<const ColumnInfo> columns_of<DisabledPairTable>();
template std::span<const ColumnInfo> columns_of<EdgeTable>();
template std::span<const ColumnInfo> columns_of<ElementBlockTable>();
template std::span<const ColumnInfo> columns_of<ElementNodeTable>();
template std::span<const ColumnInfo> columns_of<FibreTable>();
template std::span<const ColumnInfo> columns_of<ImplicitNodeTable>();
template std::span<const ColumnInfo> columns_of<JointBlockTable>();
template std::span<const ColumnInfo> columns_of<JointTable>();
template std::span<const ColumnInfo> columns_of<MaterialPairTable>();
template std::span<const ColumnInfo> columns_of<LoadTable>();
template std::span<const ColumnInfo> columns_of<MaterialTable>();
template std::span<const ColumnInfo> columns_of<NodeBlockTable>();
template std::span<const ColumnInfo> columns_of<NodeTable>();
template std::span<const ColumnInfo> columns_of<PairTable>();
template std::span<const ColumnInfo> columns_of<PipeTable>();
template std::span<const ColumnInfo> columns_of<RegionTable>();
template std::span<const ColumnInfo> columns_of<RestingContactTable>();
template std::span<const ColumnInfo> columns_of<RigidBodyTable>();
template std::span<const ColumnInfo> columns_of<SpringTable>();
template std::span<const ColumnInfo> columns_of<SurfaceSetTable>();
template std::span<const ColumnInfo> columns_of<SurfaceTables>();
template std::span<const ColumnInfo> columns_of<TetrahedronBlockTable>();
template std::span<const ColumnInfo> columns_of<TieRowTable>();
template std::span<const ColumnInfo> columns_of<TieTable>();
template std::span<const ColumnInfo> columns_of<TriangleTable>();
template std::span<const ColumnInfo> columns_of<VertexTable>();
template std::span<const ColumnInfo> columns_of<WarmStartTable>();

}  // namespace skerry
