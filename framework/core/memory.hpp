// How freed memory goes back to the system.
#pragma once

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace kerf {

/// While one of these is there, every large block is a piece of memory of its own, which the system gets back as soon
/// as it is freed: a mesh on its way between ranks is in memory two times, not three or four. Afterwards large blocks
/// come from the heap again, which is faster for what is needed in every step.
class ReturnedBlocks {
 public:
#ifdef __GLIBC__
  ReturnedBlocks() { mallopt(M_MMAP_THRESHOLD, 64 * 1024); }
  ~ReturnedBlocks() {
    malloc_trim(0);
    mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);  // the greatest that glibc takes
    mallopt(M_TRIM_THRESHOLD, 64 * 1024 * 1024);
  }
#else
  ReturnedBlocks() = default;
  ~ReturnedBlocks() {}
#endif
  ReturnedBlocks(const ReturnedBlocks&) = delete;
  ReturnedBlocks& operator=(const ReturnedBlocks&) = delete;
};

}  // namespace kerf
