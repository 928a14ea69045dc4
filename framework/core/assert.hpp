// Broken invariants of the program itself: never the user's fault, always on.
#pragma once

#include <cstdio>
#include <cstdlib>

#define KERF_ASSERT(condition, sentence)                                                                  \
  do {                                                                                                    \
    if (!(condition)) {                                                                                   \
      std::fprintf(stderr, "%s:%d: internal error: %s (%s)\n", __FILE__, __LINE__, sentence, #condition); \
      std::abort();                                                                                       \
    }                                                                                                     \
  } while (false)
