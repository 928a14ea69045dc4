// Handlers that only read, and write one line.
#include "plugin/crash_report.hpp"

#include <signal.h>

#include <cstdlib>
#include <cstring>
#include <exception>

#include "plugin/culprit.hpp"
#include "plugin/last_words.hpp"

namespace kerf {
namespace {

struct Crash {
  int number;
  const char* what;
};

constexpr Crash crashes[] = {
    {SIGSEGV, "SIGSEGV: memory that is not there, or a stack that is full"},
    {SIGBUS, "SIGBUS: memory that cannot be reached"},
    {SIGFPE, "SIGFPE: a division of whole numbers by zero"},
    {SIGILL, "SIGILL: an instruction that this processor does not know"},
    {SIGABRT, "SIGABRT: abort() was called"},
};

char uncaught[400] = "";  // what an exception says that has ended the program

const char* meaning_of(int number) {
  if (uncaught[0] != '\0') return uncaught;
  for (const Crash& c : crashes)
    if (c.number == number) return c.what;
  return "a signal";
}

void report(int number, siginfo_t*, void* context) {
  const Culprit culprit = find_culprit(context);
  LastWords words;
  if (culprit.library)
    words.add("the plugin library ").add(culprit.library).add(" has crashed").add_function(culprit);
  else
    words.add("Kerf has crashed");
  words.add(" (").add(meaning_of(number)).add("), ").add_activity();
  if (culprit.library)
    words.add("; mend the plugin, or run without it");
  else
    words.add("; no plugin library is to be seen on the stack; please report it with its input");
  words.say();
  raise(number);  // blocked until this handler, which was for once only, returns
}

void note_exception() {
  const auto note = [](const char* what) {
    std::strcpy(uncaught, "an exception that nobody catches: ");
    std::strncat(uncaught, what, sizeof uncaught - std::strlen(uncaught) - 1);
  };
  try {
    if (const std::exception_ptr e = std::current_exception())
      std::rethrow_exception(e);
    else
      std::strcpy(uncaught,
                  "std::terminate() was called, as for an exception that must not leave a function or a loop");
  } catch (const std::exception& e) {
    note(e.what());
  } catch (...) {
    note("something that is not a std::exception");
  }
  std::abort();
}

}  // namespace

void report_crashes() {
  prepare_to_find_culprits();
  // A handler for a stack that is full needs one of its own.
  static char other_stack[1 << 16];
  stack_t stack = {};
  stack.ss_sp = other_stack;
  stack.ss_size = sizeof other_stack;
  sigaltstack(&stack, nullptr);
  for (const Crash& c : crashes) {
#ifdef __SANITIZE_ADDRESS__
    if (c.number != SIGABRT) continue;  // the sanitizer tells more
#endif
    struct sigaction action = {};
    action.sa_sigaction = &report;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | static_cast<int>(SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(c.number, &action, nullptr);
  }
  std::set_terminate(&note_exception);
}

}  // namespace kerf
