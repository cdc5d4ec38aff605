#include "engine/output/page/stream/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>

#include "components/check.h"

namespace skerry {
namespace {

/// Owner of the memory that zlib allocates. It cannot be moved, because zlib's state stores the address of the
/// z_stream.
struct Stream {
    z_stream z{};

    Stream() = default;
    ~Stream() { deflateEnd(&z); }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
};

/// Checks a status returned by zlib. Throws std::bad_alloc if no memory is left. Z_BUF_ERROR only means that there was
/// nothing to do. All other errors would be bugs, because a stream is never closed twice and the output always has
/// space.
void require(int status) {
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    SKERRY_CHECK(status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR);
}

void run(z_stream& z, std::string_view bytes, int flush, std::string& out) {
    std::array<unsigned char, 1 << 16> room;
    do {
        // zlib counts bytes with an unsigned int, so longer input is passed in parts
        const std::size_t part = std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max());
        z.next_in = const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(bytes.data()));
        z.avail_in = static_cast<uInt>(part);
        bytes.remove_prefix(part);
        do {
            z.next_out = room.data();
            z.avail_out = static_cast<uInt>(room.size());
            require(deflate(&z, bytes.empty() ? flush : Z_NO_FLUSH));
            out.append(reinterpret_cast<const char*>(room.data()), room.size() - z.avail_out);
        } while (z.avail_out == 0);
    } while (!bytes.empty());
}

}  // namespace

struct Deflater::Impl {
    Stream stream;
    std::string packed;
};

Deflater::Deflater() : impl_(new Impl) {
    // Encoded changes of numbers rarely contain repeated byte sequences. Z_FILTERED is meant for such data: compressed
    // frames are 3 % smaller than with the default strategy, and compressed text is hardly larger.
    require(deflateInit2(&impl_->stream.z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, Z_FILTERED));
}

Deflater::~Deflater() = default;
Deflater::Deflater(Deflater&&) noexcept = default;
Deflater& Deflater::operator=(Deflater&&) noexcept = default;

void Deflater::add(std::string_view bytes) {
    run(impl_->stream.z, bytes, Z_NO_FLUSH, impl_->packed);
}

std::string Deflater::packed() const {
    Stream end;
    require(deflateCopy(&end.z, &impl_->stream.z));
    std::string out = impl_->packed;
    run(end.z, {}, Z_FINISH, out);
    return out;
}

}  // namespace skerry
