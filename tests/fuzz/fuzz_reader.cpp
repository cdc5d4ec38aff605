// Entry point of libFuzzer for one reader. SKERRY_READ is the reader's function.
#include "readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    skerry::test::SKERRY_READ({data, size});
    return 0;
}
