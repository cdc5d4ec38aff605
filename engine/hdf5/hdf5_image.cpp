#include "engine/hdf5/hdf5_image.h"

#include "engine/base/complaint.h"

namespace skerry {
namespace {

hid_t make_file(const std::string& name) {
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    constexpr std::size_t growth = 1 << 16;  // increment by which the image grows in memory [bytes]
    H5Pset_fapl_core(access.id(), growth, 0);
    // Time stamps are disabled, so the bytes of the file depend on its content alone.
    const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation.id(), 0);
    return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id());
}

}  // namespace

Hdf5Image::Hdf5Image(std::string name) : name_(std::move(name)), file_(make_file(name_), H5Fclose) {
    expect(file_.ok(), "/");
}

void Hdf5Image::expect(bool good, const std::string& path) const {
    if (!good)
        refuse_in(name_, {}, path, "not enough memory", "enough memory for the file",
                  "close other programs, then try again");
}

void Hdf5Image::put(const std::string& path, hid_t type, const Hdf5Handle& space, const void* values) {
    for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1)) {
        const std::string group = path.substr(0, end);
        if (H5Lexists(file_.id(), group.c_str(), H5P_DEFAULT) > 0) continue;
        const Hdf5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
        H5Pset_obj_track_times(creation.id(), 0);
        const Hdf5Handle made(H5Gcreate2(file_.id(), group.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose);
        expect(made.ok(), group);
    }
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation.id(), 0);
    const Hdf5Handle data(
        H5Dcreate2(file_.id(), path.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Dclose);
    expect(data.ok() && H5Dwrite(data.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0, path);
}

void Hdf5Image::put(const std::string& path, std::span<const Index> values) {
    const hsize_t size = values.size();
    put(path, H5T_NATIVE_INT32, Hdf5Handle(H5Screate_simple(1, &size, nullptr), H5Sclose), values.data());
}

void Hdf5Image::put(const std::string& path, std::span<const Real> values) {
    const hsize_t size = values.size();
    put(path, H5T_NATIVE_DOUBLE, Hdf5Handle(H5Screate_simple(1, &size, nullptr), H5Sclose), values.data());
}

void Hdf5Image::put_text(const std::string& path, const std::string& text) {
    const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), text.size() + 1);
    H5Tset_strpad(type.id(), H5T_STR_NULLTERM);
    put(path, type.id(), Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose), text.c_str());
}

void Hdf5Image::put_attribute(const std::string& path, const char* name, const std::string& text) {
    const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), text.size() + 1);
    H5Tset_strpad(type.id(), H5T_STR_NULLTERM);
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle attribute(
        H5Acreate_by_name(file_.id(), path.c_str(), name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    expect(attribute.ok() && H5Awrite(attribute.id(), type.id(), text.c_str()) >= 0, path);
}

std::vector<char> Hdf5Image::bytes() const {
    expect(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) >= 0, "/");
    const ssize_t size = H5Fget_file_image(file_.id(), nullptr, 0);
    expect(size > 0, "/");
    std::vector<char> image(static_cast<std::size_t>(size));
    expect(H5Fget_file_image(file_.id(), image.data(), image.size()) == size, "/");
    return image;
}

}  // namespace skerry
