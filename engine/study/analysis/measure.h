// One quantity of a study: its value in every run, and its error (docs/methods/study.md 2).
#pragma once

#include <utility>
#include <vector>

#include "engine/study/analysis/agreement.h"
#include "engine/study/analysis/convergence.h"
#include "skerry/study.h"

namespace skerry {

/// Figure: the single number to which a column (a time series) is reduced.
/// - end: value in the last row.
/// - largest, smallest: extreme value of all rows.
/// - mean: mean over time.
/// - agreed: value in the last row up to which perturbed runs agree. Their nodes are moved by at most 1e-12 m at the
///   start.
enum class StudyFigure { end, largest, smallest, mean, agreed };

/// The runs of a study, and the selection of those that can be compared with each other.
struct StudyFamily {
    const std::vector<StudyRun>* all = nullptr;
    const StudyRun* scene = nullptr;  // run of the scene as it is
    // Runs that ended well and have the columns and the number of rows of `scene`; includes `scene`.
    std::vector<const StudyRun*> comparable{};
    std::vector<Real> sizes{};  // size of the values of each column, see column_sizes()
    // Largest size of each column in all runs, if its values are only errors of the contact solver or of the steps; 0
    // for all other columns. The values are such errors if a lower tolerance or shorter steps reduce the size to less
    // than a third.
    std::vector<Real> zero_within{};

    explicit StudyFamily(const std::vector<StudyRun>& runs);
    PerturbedRuns perturbed() const;

private:
    void find_zeros();
};

/// A quantity, and the convergence of its value with the edge length, the step length and the contact tolerance.
struct MeasuredQuantity {
    StudyQuantity result;
    Convergence mesh{}, step{}, contact{};
    Real noise = 0;  // largest difference between a run with a perturbed start and the run `scene`
    std::vector<std::pair<StudyVariant, Real>> elements{};  // (variant, value) of runs with other elements
    Real shape = 0;       // part of the mesh error that refinement does not reduce, see StudyColumn::shape_error
    Real least_mesh = 0;  // lower bound of the mesh error of linear elements, from a comparison with smoothed elements
};

/// Returns the size of each column: its largest absolute value in the run, or for lengths and energies the largest
/// change since the start. The largest size of a group of columns is the size of all of them; groups are the components
/// of a vector, all energies of a probe, and all forces of a probe.
std::vector<Real> column_sizes(const StudyRun& run);

/// Returns the scale of each column, to which its errors are relative. The scale is the size of the column (see
/// column_sizes()), but at least
/// - for lengths: the rounding error of a length as large as the body,
/// - for energies: the rounding error of the largest energy of the probe,
/// - for all but energies: a millionth of the largest size of all columns with this unit,
/// - for all columns: the difference that the perturbation of the start makes in the first row, divided by
///   agreement_share.
std::vector<Real> column_scales(const StudyFamily& family);

/// Returns the figures of a column (see StudyFigure) for which the study reports an error bar. `agree_until`: time up
/// to which perturbed runs agree on the column (agreement.h) [s]. `scale`: entry of column_scales() for the column.
std::vector<StudyFigure> figures_of(const StudyFamily& family, std::size_t column, Real agree_until, Real scale);

/// Measures a figure of a column. `scale` and `agree_until` are those of figures_of(), `wanted_error` is the wanted
/// relative error.
MeasuredQuantity measure(const StudyFamily& family, std::size_t column, StudyFigure figure, Real scale,
                         Real agree_until, Real wanted_error);

/// Half width of the error bar of the quantity in a run with the settings `variant`. For meshes finer than those of all
/// runs the error is predicted. NaN if unknown.
Real error_with(const MeasuredQuantity& quantity, const StudyVariant& variant);

/// Half width of the error bar of each row of a column. NaN after `agree_until`, except for statistics of all bodies.
std::vector<Real> error_band(const StudyFamily& family, std::size_t column, Real scale, Real agree_until);

}  // namespace skerry
