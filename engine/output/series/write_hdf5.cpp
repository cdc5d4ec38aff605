// Writes time series to HDF5 files.
#include "engine/base/write_file.h"
#include "engine/hdf5/hdf5_image.h"
#include "skerry/recorder.h"

namespace skerry {

void Recorder::write_hdf5(const std::filesystem::path& file) const {
    Hdf5Image image(file.string());
    std::vector<Real> values(row_count());
    for (std::size_t c = 0; c < columns().size(); ++c) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = row(i)[c];
        const SeriesColumn& column = columns()[c];
        const std::string path = (column.probe.empty() ? "" : "/" + column.probe) + "/" + column.quantity;
        image.put(path, std::span<const Real>(values));
        image.put_attribute(path, "unit", column.unit);
    }
    const std::vector<char> bytes = image.bytes();
    write_file(file, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

}  // namespace skerry
