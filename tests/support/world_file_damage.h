// Saved worlds with wrong values: whole files with a right checksum, as damage on a disk would not make them.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "components/types.h"
#include "engine/world/save/file_head.h"

namespace skerry::test {

/// Location of the values of a data set in a file.
struct ValuesInFile {
    std::string path;
    std::size_t begin, bytes, number_bytes;
    bool reals;
};

/// Locations of the values of all data sets that have any, in the order of the names.
inline std::vector<ValuesInFile> values_in(const std::string& file) {
    std::vector<ValuesInFile> found;
    const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const auto visit = [](hid_t at, const char* name, const H5O_info_t* info, void* list) -> herr_t {
        if (info->type != H5O_TYPE_DATASET) return 0;
        const hid_t data = H5Dopen2(at, name, H5P_DEFAULT), type = H5Dget_type(data);
        if (const hsize_t bytes = H5Dget_storage_size(data); bytes > 0 && H5Tget_class(type) != H5T_STRING)
            static_cast<std::vector<ValuesInFile>*>(list)->push_back(
                {std::string("/") + name, static_cast<std::size_t>(H5Dget_offset(data)),
                 static_cast<std::size_t>(bytes), H5Tget_size(type), H5Tget_class(type) == H5T_FLOAT});
        H5Tclose(type);
        H5Dclose(data);
        return 0;
    };
    H5Ovisit(id, H5_INDEX_NAME, H5_ITER_INC, visit, &found);
    H5Fclose(id);
    return found;
}

/// Overwrites one number of a data set: `place` selects the number, `choice` the new value.
inline void change_value(const ValuesInFile& values, std::size_t place, unsigned choice, std::span<char> file) {
    constexpr Real infinite = std::numeric_limits<Real>::infinity();
    constexpr Real none = std::numeric_limits<Real>::quiet_NaN();
    constexpr std::array<Real, 10> reals{0, -1, 1, 1e300, -1e300, 1e-300, 5e-324, none, infinite, 0.5};
    constexpr std::array<std::uint64_t, 10> integers{0,       1, 2, 3, 7, 255, 65535, 0x7fffffff, ~std::uint64_t{0},
                                                     1u << 20};
    const std::size_t count = values.bytes / values.number_bytes;
    char* const at = file.data() + values.begin + place % count * values.number_bytes;
    if (values.reals)
        std::memcpy(at, &reals[choice % reals.size()], sizeof(Real));
    else
        std::memcpy(at, &integers[choice % integers.size()], values.number_bytes);
}

/// Writes a head with the checksum of the present contents of the file.
inline void renew_head(std::span<char> file) {
    const std::string head = head_of(file.subspan(head_bytes));
    std::copy(head.begin(), head.end(), file.begin());
}

}  // namespace skerry::test
