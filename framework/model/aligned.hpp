// A vector on cache-line boundaries, for arrays that are read in whole vector registers. Large ones ask for large
// pages: elements reach for nodes all over the memory, and would miss the table of small ones.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <vector>

namespace kerf {

template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::size_t line = 64, large_page = std::size_t{1} << 21;  // [bytes]
  static constexpr std::size_t large = 2 * large_page;
  static std::align_val_t alignment(std::size_t bytes) { return std::align_val_t{bytes >= large ? large_page : line}; }

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    void* p = ::operator new(bytes, alignment(bytes));
#ifdef MADV_HUGEPAGE
    if (bytes >= large) madvise(p, bytes, MADV_HUGEPAGE);  // a wish; refusal costs speed and nothing else
#endif
    return static_cast<T*>(p);
  }
  void deallocate(T* p, std::size_t n) { ::operator delete(p, alignment(n * sizeof(T))); }
  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace kerf
