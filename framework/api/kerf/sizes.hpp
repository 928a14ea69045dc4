// The sizes of the types that engine and plugins hand to each other, listed where the types are: a library that was
// compiled against other headers shows by them.
//
// A header lists every type of its namespace `kerf` that is no template, at its end:
//
//   KERF_SIZES(load, KERF_SIZE(Load), KERF_SIZE(LoadedNode))
//
// The manifest of a plugin holds the lists of the headers that its source file includes.
#pragma once

#include <cstddef>

namespace kerf {

/// The headers that have a list.
enum class ApiHeader {
  math,
  schema,
  plugin,
  curve,
  expression,
  file_mesh,
  input_files,
  shape,
  collapsed_cell,
  law,
  law_use,
  material,
  eos,
  solid,
  erosion,
  element,
  contact,
  boundary,
  load,
  mesh,
  measure,
  observer,
  partitioner,
  balance_policy,
  count
};

namespace detail {

struct SizeOf {
  const char* type;
  std::size_t bytes;
};

/// The list of a header; empty where the header is not included.
template <ApiHeader>
struct SizesIn {
  static constexpr const char* header = nullptr;
  static constexpr int n = 0;
  static constexpr SizeOf list[1] = {};
};

}  // namespace detail
}  // namespace kerf

#define KERF_SIZE(...) \
  { #__VA_ARGS__, sizeof(kerf::__VA_ARGS__) }
#define KERF_SIZES(name, ...)                                \
  template <>                                                \
  struct kerf::detail::SizesIn<kerf::ApiHeader::name> {      \
    static constexpr const char* header = #name;             \
    static constexpr SizeOf list[] = {__VA_ARGS__};          \
    static constexpr int n = sizeof(list) / sizeof(list[0]); \
  };
