// What a plugin library says of itself before anything of it is called: lines of text "key=value" under a symbol of
// their own. Text, and not a struct, so that libraries for older and newer Kerfs can be read and told apart.
#pragma once

#include <cstddef>
#include <utility>

#include "kerf/math.hpp"
#include "kerf/sizes.hpp"

namespace kerf {

#ifndef KERF_VERSION
#define KERF_VERSION "0.2.0"
#endif

// The compile flags that matter, which kerf_add_plugin() passes on; nobody knows those of a library that was compiled
// without it.
#ifndef KERF_COMPILE_FLAGS
#define KERF_COMPILE_FLAGS "unknown"
#endif

namespace detail {

/// Instruction sets that change how vectors are laid out or handed over.
inline constexpr const char* instruction_sets =
    "baseline"
#ifdef __SSE4_2__
    " sse4.2"
#endif
#ifdef __AVX__
    " avx"
#endif
#ifdef __AVX2__
    " avx2"
#endif
#ifdef __FMA__
    " fma"
#endif
#ifdef __AVX512F__
    " avx512f"
#endif
#ifdef __AVX512DQ__
    " avx512dq"
#endif
#ifdef __AVX512VL__
    " avx512vl"
#endif
#ifdef __ARM_FEATURE_SVE
    " sve"
#endif
    ;

/// What changes the layout of types of the C++ library.
inline constexpr const char* standard_library =
#if defined(_LIBCPP_VERSION)
    "libc++"
#elif defined(_GLIBCXX_DEBUG)
    "libstdc++ with _GLIBCXX_DEBUG"
#elif defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
    "libstdc++ with _GLIBCXX_USE_CXX11_ABI=0"
#else
    "libstdc++"
#endif
    ;

/// What may be assumed of numbers, whichever flag has asked for it.
inline constexpr const char* arithmetic =
#if defined(__FAST_MATH__)
    "-ffast-math"
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
    "-ffinite-math-only"
#else
    "strict"
#endif
    ;

/// Writes text one after another, or only counts its characters where there is no room given.
class ManifestWriter {
 public:
  constexpr explicit ManifestWriter(char* room) : room_(room) {}
  constexpr std::size_t length() const { return length_; }
  constexpr void add(const char* text) {
    for (; *text != '\0'; ++text) add(*text);
  }
  constexpr void add(char c) {
    if (room_) room_[length_] = c;
    ++length_;
  }
  constexpr void add(std::size_t number) {
    if (number >= 10) add(number / 10);
    add(static_cast<char>('0' + number % 10));
  }
  template <class Value>
  constexpr void line(const char* key, Value value) {
    add(key);
    add('=');
    add(value);
    add('\n');
  }

 private:
  char* room_;
  std::size_t length_ = 0;
};

template <class Sizes>
constexpr void write_sizes(ManifestWriter& to) {
  for (int i = 0; i < Sizes::n; ++i) {
    to.add("size.");
    to.add(Sizes::header);
    to.add('.');
    to.line(Sizes::list[i].type, Sizes::list[i].bytes);
  }
}

/// `At` is a type that no other source file has: the lists are looked for where it is named, behind all headers.
template <class At, int interface, std::size_t... header>
constexpr std::size_t write_manifest(char* room, std::index_sequence<header...>) {
  ManifestWriter to(room);
  to.line("interface", static_cast<std::size_t>(interface));
  to.line("kerf", KERF_VERSION);
  to.line("compiler", __VERSION__);
  to.line("lane_width", static_cast<std::size_t>(lane_width));
  to.line("flags", KERF_COMPILE_FLAGS);
  to.line("instructions", instruction_sets);
  to.line("arithmetic", arithmetic);
  to.line("standard_library", standard_library);
  (write_sizes<SizesIn<static_cast<ApiHeader>(header)>>(to), ...);
  return to.length();
}

template <std::size_t n>
struct ManifestText {
  char text[n + 1] = {};
};

template <class At, int interface>
consteval auto manifest_text() {
  constexpr std::make_index_sequence<static_cast<std::size_t>(ApiHeader::count)> headers;
  ManifestText<write_manifest<At, interface>(nullptr, headers)> manifest;
  write_manifest<At, interface>(manifest.text, headers);
  return manifest;
}

}  // namespace detail
}  // namespace kerf
