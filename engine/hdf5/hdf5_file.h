// Reads named numbers from an HDF5 file, with complaints that say which. Nothing is printed: HDF5's own messages are
// switched off while it is read.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/row_type.h"
#include "components/types.h"
#include "jobs/function_ref.h"
#include "skerry/error.h"

namespace skerry {

/// Something of HDF5's that has to be closed.
class Hdf5Handle {
public:
    Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Hdf5Handle() {
        if (id_ >= 0) close_(id_);
    }
    Hdf5Handle(const Hdf5Handle&) = delete;
    Hdf5Handle& operator=(const Hdf5Handle&) = delete;
    hid_t id() const { return id_; }
    bool ok() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// Keeps HDF5 from printing, as long as it lives; the host's own handler comes back afterwards.
class QuietHdf5 {
public:
    QuietHdf5() {
        H5Eget_auto2(H5E_DEFAULT, &handler_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, handler_, data_); }
    QuietHdf5(const QuietHdf5&) = delete;
    QuietHdf5& operator=(const QuietHdf5&) = delete;

private:
    H5E_auto2_t handler_ = nullptr;
    void* data_ = nullptr;
};

/// The type of HDF5 that such numbers have in memory and in files.
hid_t hdf5_type(NumberType type);

/// An open file. Paths are absolute, "/group/field". All reading throws SceneError on what is missing or of another
/// kind.
class Hdf5File {
public:
    /// `expected`: what a complaint about the file as a whole says that it ought to be.
    Hdf5File(const std::filesystem::path& path, const std::string& expected);

    bool has(const std::string& path) const;
    void expect_group(const std::string& path, const std::string& hint = {}) const;
    Index integer(const std::string& path) const;
    std::vector<Index> integers(const std::string& path) const;
    std::vector<Real> reals(const std::string& path) const;  // all finite
    /// A column of numbers of exactly this type, so that they keep their bits, in rows of `width`: two dimensions if
    /// that is more than one. `place` makes room for so many rows and says where.
    void read_rows(const std::string& path, hid_t memory_type, std::size_t width,
                   FunctionRef<void*(std::size_t)> place) const;
    /// Text that a file may have: empty when it has none.
    std::string text_or_nothing(const std::string& path) const;

    [[noreturn]] void complain(const std::string& path, const std::string& found, const std::string& expected,
                               const std::string& hint = {}) const;

private:
    /// Whether so much can come out of the file: a few bytes of it may claim any size.
    bool can_hold(hsize_t bytes) const;
    template <class T>
    std::vector<T> numbers(const std::string& path, H5T_class_t kind, hid_t memory_type, const char* expected) const;

    QuietHdf5 quiet_;
    std::string name_;
    Hdf5Handle file_;
};

}  // namespace skerry
