// A thread that looks at a counter, and a handler that speaks for the thread that computes.
#include "plugin/stall_watch.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "core/diagnostics.hpp"
#include "plugin/culprit.hpp"
#include "plugin/last_words.hpp"

namespace kerf {
namespace {

/// How long a rank may wait for others [s]. What one of them does alone must not stop a run that is well, and one that
/// stands still speaks first, and needs some seconds to end the others.
double patience_of_waiting(double limit) { return 2.0 * limit + 10.0; }
constexpr double time_to_speak = 5.0;  // for a thread that was asked [s]

std::atomic<bool> has_waited_long{false};
std::atomic<bool> was_asked{false};  // and has not answered
std::atomic<std::uint64_t> beats_when_asked{0};

int signal_of_watch() { return SIGRTMIN + 5; }

/// Writes what stands still and ends the program. Without `answered` the thread that computes cannot be interrupted.
[[noreturn]] void stop(const Culprit& culprit, bool answered) {
  LastWords words;
  words.add(culprit.waits ? "other ranks were waited for for " : "nothing has come to an end for ")
      .add_seconds(culprit.waits ? patience_of_waiting(activity::limit) : activity::limit.load())
      .add(culprit.waits ? " (more than twice " : " (")
      .add(activity::limit_name.load())
      .add("), ")
      .add_activity();
  if (culprit.waits && culprit.library)
    words.add(", in a call of MPI by the plugin library ").add(culprit.library).add_function(culprit);
  if (culprit.waits)
    words.add(", and none of them has said why; a plugin may have called MPI on some ranks only");
  else if (culprit.library)
    words.add("; the plugin library ")
        .add(culprit.library)
        .add(" is still")
        .add(culprit.function ? "" : " at work")
        .add_function(culprit)
        .add("; mend a loop in it that never ends, or raise the limit");
  else if (!answered)
    words.add("; the system does not come back from a call, perhaps to a disk; raise the limit, or look there");
  else
    words.add("; no plugin library is to be seen on the stack; raise the limit, or report it with its input");
  words.say();
  _exit(activity::exit_code);
}

/// Runs in the thread that computes.
void answer(int, siginfo_t*, void* context) {
  was_asked = false;
  if (activity::beats != beats_when_asked) return;  // something has come to an end just now
  const Culprit culprit = find_culprit(context);
  if (!culprit.waits || has_waited_long) stop(culprit, true);
}

/// The time without a beat is counted in looks, not read from a clock: a program that was suspended has not stood
/// still.
class Watch {
 public:
  explicit Watch(pthread_t computes) : computes_(computes) {}

  [[noreturn]] void run() {
    for (;;) {
      const double limit = activity::limit;  // before the beats: see Task
      const double pause = limit > 0.0 ? std::clamp(0.02 * limit, 0.02, 1.0) : 0.2;
      look(limit);
      std::this_thread::sleep_for(std::chrono::duration<double>(pause));
      idle_ += pause;
    }
  }

 private:
  void look(double limit) {
    const std::uint64_t beats = activity::beats.load(std::memory_order_relaxed);
    if (beats != beats_ || !(limit > 0.0)) {
      beats_ = beats;
      idle_ = 0.0;
      asked_ = 0;
      was_asked = has_waited_long = false;
    } else if (asked_ == 0 && idle_ >= limit) {
      ask();
    } else if (asked_ == 1 && idle_ >= patience_of_waiting(limit)) {
      has_waited_long = true;
      ask();
    } else if (asked_ > 0 && was_asked && idle_ >= (asked_ == 1 ? limit : patience_of_waiting(limit)) + time_to_speak) {
      stop({}, false);
    }
  }
  void ask() {
    ++asked_;
    was_asked = true;
    beats_when_asked = beats_;
    pthread_kill(computes_, signal_of_watch());
  }

  pthread_t computes_;
  std::uint64_t beats_ = 0;
  double idle_ = 0.0;  // [s]
  int asked_ = 0;
};

}  // namespace

void watch_for_stalls() {
  prepare_to_find_culprits();
  struct sigaction action = {};
  action.sa_sigaction = &answer;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(signal_of_watch(), &action, nullptr);
  // Signals are for the thread that computes.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread([computes = pthread_self()] { Watch(computes).run(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

activity::Limit load_limit() {
  constexpr int exit_code_of_a_bad_plugin = 2;
  activity::Limit limit = {60.0, "KERF_LOAD_LIMIT", exit_code_of_a_bad_plugin};
  const char* text = std::getenv(limit.name);
  if (!text || *text == '\0') return limit;
  const std::string_view given(text);
  const auto [end, status] = std::from_chars(given.data(), given.data() + given.size(), limit.seconds);
  if (status != std::errc() || end != given.data() + given.size() || !(limit.seconds >= 0.0) ||
      !std::isfinite(limit.seconds))
    throw InputError(
        {fmt::format("{}: error: \"{}\" in the environment is no number of seconds; expected one such as "
                     "60, or 0 for no limit",
                     limit.name, given)});
  return limit;
}

}  // namespace kerf
