// The parts of the extension module _core, and helpers that all parts use. Users import the package skerry, whose
// Python files check and document the arguments, and pass NumPy arrays and handles on to _core.
#pragma once

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <cstring>
#include <span>
#include <vector>

#include "components/types.h"

namespace skerry::python {

namespace nb = nanobind;

// Each function adds one part to the module.
void bind_errors(nb::module_& module);
void bind_settings(nb::module_& module);
void bind_live(nb::module_& module);
void bind_materials(nb::module_& module);
void bind_mesh(nb::module_& module);
void bind_problem(nb::module_& module);
void bind_estimate(nb::module_& module);
void bind_recorder(nb::module_& module);
void bind_rollout(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_study(nb::module_& module);
void bind_visual_surface(nb::module_& module);
void bind_world(nb::module_& module);

/// Arrays that Python passes in: C-contiguous, with exactly these element types.
using Vectors = nb::ndarray<const Real, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Reals = nb::ndarray<const Real, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const Index, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
template <Py_ssize_t width>
using IndexRows = nb::ndarray<const Index, nb::shape<-1, width>, nb::c_contig, nb::device::cpu>;

inline std::span<const Vec3> span_of(const Vectors& rows) {
    return {reinterpret_cast<const Vec3*>(rows.data()), rows.shape(0)};
}
inline std::span<const Index> span_of(const Indices& values) {
    return {values.data(), values.shape(0)};
}
template <Py_ssize_t width>
std::span<const std::array<Index, static_cast<std::size_t>(width)>> span_of(const IndexRows<width>& rows) {
    return {reinterpret_cast<const std::array<Index, static_cast<std::size_t>(width)>*>(rows.data()), rows.shape(0)};
}

/// A new NumPy array of shape (rows.size(), row_shape...) with a copy of the numbers in `rows`.
template <class Number, class Row>
nb::ndarray<nb::numpy, Number> array_of(std::span<const Row> rows, std::initializer_list<std::size_t> row_shape = {}) {
    static_assert(sizeof(Row) % sizeof(Number) == 0 && std::is_trivially_destructible_v<Row>);
    auto* data = new Number[rows.size() * sizeof(Row) / sizeof(Number)];
    if (!rows.empty()) std::memcpy(static_cast<void*>(data), rows.data(), rows.size_bytes());
    nb::capsule owner(data, [](void* owned) noexcept { delete[] static_cast<Number*>(owned); });
    std::vector<std::size_t> shape{rows.size()};
    shape.insert(shape.end(), row_shape.begin(), row_shape.end());
    return {data, shape.size(), shape.data(), owner};
}
inline nb::ndarray<nb::numpy, Real> array_of(std::span<const Vec3> rows) {
    return array_of<Real>(rows, {3});
}
inline nb::ndarray<nb::numpy, Real> array_of(const std::vector<Vec3>& rows) {
    return array_of(std::span<const Vec3>(rows));
}

/// Counts the calls that run without the GIL (global interpreter lock). A thread that requests the GIL of an ended
/// Python aborts the process. So before Python ends, end_calls() makes all running and new calls of other threads raise
/// SystemExit.
class CallScope {
public:
    CallScope() {
        raise_at_exit();
        ++running;
    }
    ~CallScope() { --running; }
    CallScope(const CallScope&) = delete;
    CallScope& operator=(const CallScope&) = delete;

    /// Raises SystemExit, which ends a thread without a message, if another thread has called end_calls(). May be
    /// called without the GIL.
    static void raise_at_exit();
    /// From now on raise_at_exit() raises SystemExit in all threads but the calling one. Returns the number of calls
    /// that still run.
    static int end_calls();
    /// Called after fork() in the child process, where only the calling thread exists, so that no other call runs.
    static void note_fork() { running = 0; }

private:
    static inline std::atomic<int> running{0};
    static inline std::atomic<unsigned long> ending{0};  // identifier of the thread that called end_calls(), or 0
};

/// Calls a function without the GIL.
template <class Function>
auto without_gil(Function&& function) {
    const CallScope scope;  // is destroyed after `released`, so that the call counts until the GIL is held again
    nb::gil_scoped_release released;
    return function();
}

}  // namespace skerry::python
