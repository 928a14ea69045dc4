// Texts and numbers in a buffer of fixed length; what does not fit is cut off.
#include "plugin/last_words.hpp"

#include <unistd.h>

#include "core/activity.hpp"

namespace kerf {

LastWords::LastWords() {
  add("error: ");
  if (const int rank = activity::rank; rank >= 0) add("rank ").add(rank).add(": ");
}

LastWords& LastWords::add(const char* text) {
  for (; *text != '\0' && length_ + 1 < sizeof text_; ++text) text_[length_++] = *text;
  return *this;
}

LastWords& LastWords::add(std::int64_t number) {
  char digits[24];
  char* at = digits + sizeof digits - 1;
  *at = '\0';
  auto left = static_cast<std::uint64_t>(number < 0 ? -number : number);
  do *--at = static_cast<char>('0' + left % 10);
  while ((left /= 10) != 0);
  if (number < 0) *--at = '-';
  return add(at);
}

LastWords& LastWords::add_seconds(double seconds) {
  const auto tenths = static_cast<std::int64_t>(seconds * 10.0 + 0.5);
  add(tenths / 10);
  if (tenths % 10 != 0) add(".").add(tenths % 10);
  return add(" s");
}

LastWords& LastWords::add_activity() {
  const char* phase = activity::phase;
  if (!phase) return add("while ").add(activity::task.load());
  add("in phase ").add(phase);
  const std::int64_t cycle = activity::cycle;
  return cycle > 0 ? add(" of cycle ").add(cycle) : add(" before the first cycle");
}

LastWords& LastWords::add_function(const Culprit& culprit) {
  return culprit.function ? add(" in ").add(culprit.function) : *this;
}

void LastWords::say() {
  text_[length_++] = '\n';
  const char* at = text_;
  while (length_ > 0) {
    const ssize_t written = write(STDERR_FILENO, at, length_);
    if (written <= 0) return;  // nobody to tell
    at += written;
    length_ -= static_cast<std::size_t>(written);
  }
}

}  // namespace kerf
