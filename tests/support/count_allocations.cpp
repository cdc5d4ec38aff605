// Replaces operator new of a whole program by one that counts, and that can fail.
#include "tests/support/count_allocations.h"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace skerry::test {

std::atomic<long> allocations{0};
thread_local long allocations_until_failure = -1;

}  // namespace skerry::test

namespace {

void* counted(std::size_t size, std::size_t alignment) {
    ++skerry::test::allocations;
    if (skerry::test::allocations_until_failure >= 0 && skerry::test::allocations_until_failure-- == 0)
        throw std::bad_alloc();
    void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t size) {
    return counted(size + (size == 0), alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return counted(size + (size == 0), static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
