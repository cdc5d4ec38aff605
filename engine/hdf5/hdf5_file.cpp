#include "engine/hdf5/hdf5_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/complaint.h"

namespace skerry {
namespace {

hid_t open_file(const std::filesystem::path& path, const std::string& expected) {
    const auto refuse = [&](const std::string& found, const std::string& hint) {
        refuse_in(path.string(), {}, {}, found, expected, hint);
    };
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) refuse("no such file", "check the path");
    if (std::filesystem::is_directory(path, ignored)) refuse("a folder", "give the path of a file");
    if (H5Fis_hdf5(path.string().c_str()) <= 0) refuse("a file that is not in HDF5 format", "check the path");
    const hid_t file = H5Fopen(path.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0)
        refuse("an HDF5 file that cannot be opened", "check the permissions of the file, or replace a damaged file");
    return file;
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path, const std::string& expected)
    : name_(path.string()), file_(open_file(path, expected), H5Fclose) {}

bool Hdf5File::can_hold(hsize_t bytes) const {
    // Largest compression ratio that the deflate filter can reach. No other filter that is common in such files
    // compresses more.
    constexpr hsize_t largest_ratio = 1032;
    hsize_t size = 0;
    return H5Fget_filesize(file_.id(), &size) >= 0 && bytes / largest_ratio <= size;
}

void Hdf5File::complain(const std::string& path, const std::string& found, const std::string& expected,
                        const std::string& hint) const {
    const std::size_t slash = path.rfind('/');
    const std::string object = slash == 0 ? "" : path.substr(0, slash);
    refuse_in(name_, object, path.substr(slash + 1), found, expected, hint);
}

bool Hdf5File::has(const std::string& path) const {
    // H5Lexists checks only the last link of a path, so every prefix of the path is checked.
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
        if (H5Lexists(file_.id(), path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
        if (end == std::string::npos) return true;
    }
}

void Hdf5File::expect_group(const std::string& path, const std::string& hint) const {
    if (!has(path)) complain(path, "nothing", "a group", hint);
    const Hdf5Handle group(H5Gopen2(file_.id(), path.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.ok()) complain(path, "an HDF5 object that is not a group", "a group", hint);
}

namespace {

const char* name_of(H5T_class_t type) {
    switch (type) {
        case H5T_INTEGER:
            return "integers";
        case H5T_FLOAT:
            return "floating-point numbers";
        case H5T_STRING:
            return "text";
        default:
            return "values that are not numbers";
    }
}

/// True if the file stores at least as many bytes as the values of the data set need. Otherwise libhdf5 would read past
/// the end of a compact data set. Chunked data sets may be compressed, so their size is not checked.
bool all_stored(const Hdf5Handle& data, const Hdf5Handle& type, hssize_t count) {
    const Hdf5Handle creation(H5Dget_create_plist(data.id()), H5Pclose);
    const H5D_layout_t layout = H5Pget_layout(creation.id());
    if (layout == H5D_CHUNKED) return true;
    return H5Dget_storage_size(data.id()) >= static_cast<hsize_t>(count) * H5Tget_size(type.id());
}

}  // namespace

template <class T>
std::vector<T> Hdf5File::numbers(const std::string& path, H5T_class_t kind, hid_t memory_type,
                                 const char* expected) const {
    if (!has(path)) complain(path, "nothing", expected);
    const Hdf5Handle data(H5Dopen2(file_.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.ok()) complain(path, "an HDF5 object that is not a data set", expected);
    const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(data.id()), H5Sclose);
    if (!type.ok() || !space.ok()) complain(path, "a data set whose type or shape cannot be read", expected);
    const H5T_class_t found = H5Tget_class(type.id());
    // integers are accepted where reals are expected
    if (found != kind && !(kind == H5T_FLOAT && found == H5T_INTEGER)) complain(path, name_of(found), expected);
    // Number types longer than a long double are refused. To convert such numbers, libhdf5 would allocate memory of the
    // size that the file claims.
    constexpr std::size_t longest_number = 16;  // [bytes]
    if (H5Tget_size(type.id()) > longest_number)
        complain(path, "values of " + std::to_string(H5Tget_size(type.id())) + " bytes",
                 std::string(expected) + " of at most " + std::to_string(longest_number) + " bytes");
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    if (count < 0 || count > std::numeric_limits<Index>::max())
        complain(path, std::to_string(count) + " values", "at most 2147483647 values");
    if (!can_hold(static_cast<hsize_t>(count) * sizeof(T)))
        complain(path, std::to_string(count) + " values", "a number of values that fits the size of the file",
                 "replace the damaged file");
    if (!all_stored(data, type, count))
        complain(path, "fewer bytes than " + std::to_string(count) + " values need", expected,
                 "replace the damaged file");
    std::vector<T> values(static_cast<std::size_t>(count));
    if (count > 0 && H5Dread(data.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
        complain(path, "values that cannot be read", expected,
                 "the data set is damaged, or the HDF5 library lacks the filter that compressed it");
    return values;
}

void Hdf5File::expect_offsets(const std::string& path, std::span<const Index> offset, std::size_t items) const {
    skerry::expect_offsets(
        offset, items, [&](const std::string& found, const std::string& expected) { complain(path, found, expected); });
}

Index Hdf5File::integer(const std::string& path) const {
    const std::vector<Index> values = integers(path);
    if (values.size() != 1) complain(path, std::to_string(values.size()) + " values", "one integer");
    return values[0];
}

std::vector<Index> Hdf5File::integers(const std::string& path) const {
    return numbers<Index>(path, H5T_INTEGER, H5T_NATIVE_INT32, "integers");
}

std::vector<Real> Hdf5File::reals(const std::string& path) const {
    std::vector<Real> values = numbers<Real>(path, H5T_FLOAT, H5T_NATIVE_DOUBLE, "numbers");
    const auto bad = std::find_if(values.begin(), values.end(), [](Real value) { return !std::isfinite(value); });
    if (bad != values.end())
        complain(path, short_text(*bad) + " at entry " + std::to_string(bad - values.begin()), "finite numbers");
    return values;
}

std::string Hdf5File::text_or_nothing(const std::string& path) const {
    if (!has(path)) return {};
    const Hdf5Handle data(H5Dopen2(file_.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.ok()) return {};
    const Hdf5Handle type(H5Dget_type(data.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(data.id()), H5Sclose);
    if (!type.ok() || !space.ok() || H5Tget_class(type.id()) != H5T_STRING ||
        H5Sget_simple_extent_npoints(space.id()) != 1)
        return {};
    if (H5Tis_variable_str(type.id()) > 0) {
        char* text = nullptr;
        if (H5Dread(data.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &text) < 0 || !text) return {};
        const std::string result = text;
        H5free_memory(text);
        return result;
    }
    if (!can_hold(H5Tget_size(type.id()))) return {};
    if (!all_stored(data, type, 1)) return {};
    std::string text(H5Tget_size(type.id()), '\0');
    if (H5Dread(data.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) return {};
    return text.substr(0, text.find('\0'));  // the stored text may or may not end with a zero byte
}

}  // namespace skerry
