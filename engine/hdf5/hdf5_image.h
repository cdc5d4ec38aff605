// Creates an HDF5 file in memory. It uses the data types of the writer of FCLIB, a collection of frictional contact
// problems: one-dimensional arrays of numbers, and fixed-length texts.
#pragma once

#include <hdf5.h>

#include <span>
#include <string>
#include <vector>

#include "components/types.h"
#include "engine/hdf5/hdf5_file.h"

namespace skerry {

/// An HDF5 file in memory. Paths are absolute, in the form "/group/field"; missing groups are created. The same
/// sequence of calls gives the same bytes. If memory runs out, the functions throw SceneError with the name given to
/// the constructor.
class Hdf5Image {
public:
    explicit Hdf5Image(std::string name);

    void put(const std::string& path, Index value) { put(path, std::span<const Index>(&value, 1)); }
    void put(const std::string& path, std::span<const Index> values);
    void put(const std::string& path, std::span<const Real> values);
    void put_text(const std::string& path, const std::string& text);
    /// Adds a text attribute to the object at the path.
    void put_attribute(const std::string& path, const char* name, const std::string& text);
    /// Returns the bytes of the whole file.
    std::vector<char> bytes() const;

private:
    void put(const std::string& path, hid_t type, const Hdf5Handle& space, const void* values);
    void expect(bool ok, const std::string& path) const;

    QuietHdf5 quiet_;
    std::string name_;
    Hdf5Handle file_;
};

}  // namespace skerry
