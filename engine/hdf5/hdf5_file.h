// Reads data sets with given names from an HDF5 file. Error messages name the data set. HDF5's own messages are
// disabled while the file is open, so nothing is printed.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/types.h"
#include "skerry/error.h"

namespace skerry {

/// Owns an HDF5 identifier and closes it.
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

/// While this object exists, HDF5 prints no messages of its own. The destructor restores the previous error handler.
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

/// An open HDF5 file. Paths are absolute, in the form "/group/field". All functions that read throw SceneError if an
/// object is missing or has another type than expected, except text_or_nothing().
class Hdf5File {
public:
    /// Opens the file for reading. `expected` describes the expected file in error messages.
    Hdf5File(const std::filesystem::path& path, const std::string& expected);

    bool has(const std::string& path) const;
    void expect_group(const std::string& path, const std::string& hint = {}) const;
    /// Checks that the offsets of a list of rows begin at 0, ascend and do not exceed the number of items.
    void expect_offsets(const std::string& path, std::span<const Index> offset, std::size_t items) const;
    Index integer(const std::string& path) const;
    std::vector<Index> integers(const std::string& path) const;
    std::vector<Real> reals(const std::string& path) const;  // all values must be finite
    /// Reads an optional text. Returns an empty text if the file does not contain the text.
    std::string text_or_nothing(const std::string& path) const;

    [[noreturn]] void complain(const std::string& path, const std::string& found, const std::string& expected,
                               const std::string& hint = {}) const;

private:
    /// True if the file is large enough to contain this number of bytes, even if the bytes are compressed. Without this
    /// check a small corrupt file could claim to contain data of any size.
    bool can_hold(hsize_t bytes) const;
    template <class T>
    std::vector<T> numbers(const std::string& path, H5T_class_t kind, hid_t memory_type, const char* expected) const;

    QuietHdf5 quiet_;
    std::string name_;
    Hdf5Handle file_;
};

}  // namespace skerry
