// Walks the stack and compares its places with the plugin libraries that were loaded. No memory is asked for.
#include "plugin/culprit.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <ucontext.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>

namespace kerf {
namespace {

struct KnownLibrary {
  std::string path;
  std::vector<LibraryFunction> functions;
};

// A handler must not see the list while it moves: it has its place from the start, and only its length changes. The
// libraries stay loaded until the program ends, and so does what is known of them.
constexpr std::size_t most_libraries = 256;
std::array<const KnownLibrary*, most_libraries> known{};
std::atomic<std::size_t> n_known{0};

const KnownLibrary* find_known(const char* path) {
  for (std::size_t i = 0; i < n_known.load(std::memory_order_acquire); ++i)
    if (std::strcmp(known[i]->path.c_str(), path) == 0) return known[i];
  return nullptr;
}

/// Pre: the functions are sorted by place.
const char* function_at(const KnownLibrary& library, std::uint64_t place) {
  const auto& all = library.functions;
  const auto next = std::upper_bound(all.begin(), all.end(), place,
                                     [](std::uint64_t p, const LibraryFunction& f) { return p < f.begin; });
  if (next == all.begin()) return nullptr;
  const LibraryFunction& f = *(next - 1);
  return place < f.end ? f.name.c_str() : nullptr;
}

bool is_mpi(const char* path) {
  const char* slash = std::strrchr(path, '/');
  return std::strncmp(slash ? slash + 1 : path, "libmpi", 6) == 0;
}

struct Interrupted {
  void* place = nullptr;  // the instruction that was interrupted
  void* caller = nullptr;  // where it would return to, if it has only just been called
};

Interrupted interrupted_at([[maybe_unused]] void* context) {
  Interrupted at;
#if defined(__x86_64__)
  if (!context) return at;
  const auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  at.place = reinterpret_cast<void*>(registers[REG_RIP]);
  Dl_info info;
  // A call of what is no function has left its way back on top of the stack, and cannot be followed in another way.
  if (dladdr(at.place, &info) == 0) at.caller = *reinterpret_cast<void**>(registers[REG_RSP]);
#elif defined(__aarch64__)
  if (!context) return at;
  const auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext;
  at.place = reinterpret_cast<void*>(registers.pc);
  Dl_info info;
  if (dladdr(at.place, &info) == 0) at.caller = reinterpret_cast<void*>(registers.regs[30]);
#endif
  return at;
}

/// Looks at one call; whether it settles the question.
bool settles(void* frame, const Interrupted& at, Culprit& found) {
  // Calls leave the place behind them on the stack, which may belong to the next function already.
  const std::uint64_t place = reinterpret_cast<std::uint64_t>(frame) - (frame == at.place ? 0 : 1);
  Dl_info info;
  if (dladdr(reinterpret_cast<void*>(place), &info) == 0 || !info.dli_fname) return false;
  if (!found.library && is_mpi(info.dli_fname)) found.waits = true;
  const KnownLibrary* library = find_known(info.dli_fname);
  if (!library || (found.library && library->path != found.library)) return false;
  found.library = library->path.c_str();
  found.function = function_at(*library, place - reinterpret_cast<std::uint64_t>(info.dli_fbase));
  return found.function != nullptr;
}

}  // namespace

void remember_library(const std::string& path, std::vector<LibraryFunction> functions) {
  const std::size_t n = n_known.load(std::memory_order_relaxed);
  if (n == most_libraries || find_known(path.c_str())) return;
  known[n] = new KnownLibrary{path, std::move(functions)};
  n_known.store(n + 1, std::memory_order_release);
}

void prepare_to_find_culprits() {
  void* frame = nullptr;
  backtrace(&frame, 1);
}

Culprit find_culprit(void* context) {
  constexpr int most = 128;
  void* frames[most];
  Culprit found;
  const Interrupted at = interrupted_at(context);
  if (at.caller && settles(at.caller, at, found)) return found;
  const int n = backtrace(frames, most);
  for (int i = 0; i < n; ++i)
    if (settles(frames[i], at, found)) return found;
  return found;
}

}  // namespace kerf
