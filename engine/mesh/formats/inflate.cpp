#include "engine/mesh/formats/inflate.h"

#include <zlib.h>

#include <limits>
#include <new>

namespace skerry::mesh {

std::optional<std::string> inflated(std::string_view packed, std::size_t size) {
    if (packed.size() > std::numeric_limits<uLong>::max() || size > std::numeric_limits<uLong>::max()) return {};
    std::string bytes(size, '\0');
    uLongf length = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status != Z_OK || length != size) return {};
    return bytes;
}

}  // namespace skerry::mesh
