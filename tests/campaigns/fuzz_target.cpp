// What the fuzzer calls: the whole path from the bytes of an input file to a checked model.
#include <cstdint>
#include <string>

#include "core/diagnostics.hpp"
#include "input/read_model.hpp"
#include "plugin/registry.hpp"

/// An input is read, or refused by InputError. Everything else ends the process, which the fuzzer reports.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const kerf::Registry registry = [] {
    kerf::Registry r;
    kerf::register_builtin_plugins(r);
    return r;
  }();
  kerf::Diagnostics diagnostics;
  kerf::OriginMap origins;
  try {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    const auto input = kerf::read_model_input("fuzz.yaml", bytes, {}, registry, diagnostics, origins);
    kerf::validate(*input, origins, diagnostics);
    diagnostics.throw_if_errors();
  } catch (const kerf::InputError&) {
  }
  return 0;
}
