// Composition of the tables of a model from rows of other models.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/any_table.h"
#include "engine/world/edit/row_moves.h"
#include "engine/world/ranks/hold/whole_world.h"
#include "engine/world/state/model.h"

namespace skerry {

/// A model that gives rows to a new model.
struct RowSource {
    Model* model;
    std::span<const Index> world_row;
    std::span<const std::uint8_t>
        marked;           // by row of BodyTable: nonzero for a body that the new model gets; empty: all
    Index watched, kept;  // StepWatch::body and StepWatch::kept
    StepEvaluation evaluation;
    // True if the model also gives the rows of joints, cables, loads and so on (Model::for_each_joining) that refer to
    // no body, for example a load that acts on all bodies.
    bool gives_common;
    bool is_used_up = false;  // true: the columns of its bodies are freed as soon as they are copied
    RowMoves moves{};         // new numbers of the rows; the lists of removed rows are not set
    std::vector<std::vector<AnyColumn>> columns = columns_by_body_table(*model);

    bool gives(std::size_t body) const { return marked.empty() || marked[body] != 0; }
};

/// Copies the rows that the sources give to the empty model `to`: rows of bodies, of attachments and of tables that
/// join bodies. The new rows are in the order of the undivided world. Sets RowSource::moves. Returns the row of each
/// body in the undivided world.
Column<Index> compose_rows(std::span<RowSource> sources, const WholeWorld& whole, Model& to);

/// Appends a row of `from` to the table `to`. Columns that contain lists (has_row_each is false) are left out.
void append_row(AnyTable from, std::size_t row, AnyTable to);

}  // namespace skerry
