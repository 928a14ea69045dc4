// All that a law keeps is in the state that it declares: it survives a record, and a law serves many elements.
#include <fmt/format.h>

#include "conformance/checks.hpp"
#include "conformance/law_path.hpp"

namespace kerf {

namespace {

constexpr int steps = 200, cells = 2;  // eight elements: all lanes of a block

using Driver = PathDriver<double>;
using Records = std::vector<std::vector<double>>;

/// Number of entries in which records differ, bit for bit but for NaN.
int n_different(const Records& a, const Records& b) {
  int n = 0;
  for (std::size_t e = 0; e < a.size(); ++e)
    for (std::size_t i = 0; i < a[e].size(); ++i)
      n += !(a[e][i] == b[e][i] || (a[e][i] != a[e][i] && b[e][i] != b[e][i]));
  return n;
}

Records records_of(Driver& d) { return d.part().save().records; }

void check_restart(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  StretchPath path = path_of(sample);
  path.angle = 1.0;
  const double dt = path.duration / steps;
  const SampleLaws first(registry, sample), second(registry, sample);
  Driver whole(first, path, cells), resumed(second, path, cells);
  whole.go(steps / 2, dt, 0);
  const auto saved = whole.part().save();
  resumed.part().restore(saved);
  resumed.set_time(whole.time());
  whole.go(steps / 2, dt, 0);
  resumed.go(steps / 2, dt, 0);
  const int n = n_different(records_of(whole), records_of(resumed));
  if (n == 0)
    out.pass("restart", fmt::format("packed after {} steps and unpacked for another law object, it goes on with the "
                                    "same bits",
                                    steps / 2));
  else
    out.fail("restart",
             fmt::format("packed after {} steps and unpacked for another law object, {} of {} numbers differ "
                         "{} steps later; declare everything that the law remembers in its State",
                         steps / 2, n, saved.records.size() * saved.records.front().size(), steps / 2));
}

/// Two elements on different paths, step by step in turn, with one law object; and each alone with a law of its own.
void check_hidden(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  StretchPath one = path_of(sample), other = one;
  other.strain *= -0.6;
  other.compression *= 1.2;
  const double dt = one.duration / steps;
  const SampleLaws shared(registry, sample);
  Driver a(shared, one, cells), b(shared, other, cells);
  for (int k = 0; k < steps; ++k) {
    a.go(1, dt, 0);
    b.go(1, dt, 0);
  }
  int n = 0;
  const StretchPath* paths[2] = {&one, &other};
  Driver* together[2] = {&a, &b};
  for (int k = 0; k < 2; ++k) {
    const SampleLaws own(registry, sample);
    Driver alone(own, *paths[k], cells);
    for (int i = 0; i < steps; ++i) alone.go(1, dt, 0);
    n += n_different(records_of(*together[k]), records_of(alone));
  }
  // Once more with the law that has worked before.
  Driver again(shared, one, cells);
  for (int i = 0; i < steps; ++i) again.go(1, dt, 0);
  n += n_different(records_of(a), records_of(again));
  if (n == 0)
    out.pass("hidden_state", "elements in turn, each alone, and one a second time give the same bits");
  else
    out.fail("hidden_state", fmt::format("one law object for two elements in turn gives other bits than a law object "
                                         "for each, or a path other bits the second time: {} numbers differ; a law "
                                         "must change nothing but its State: no static, no mutable members",
                                         n));
}

}  // namespace

void check_state(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const auto guarded = [&](const char* check, auto work) {
    if (!out.wants(check)) return;
    try {
      work(registry, sample, out);
    } catch (const std::exception& e) {
      out.fail(check, fmt::format("the path cannot be gone to its end: {}", sentence_of(e)));
    }
  };
  guarded("restart", check_restart);
  guarded("hidden_state", check_hidden);
}

std::string sentence_of(const std::exception& e) {
  if (const auto* input = dynamic_cast<const InputError*>(&e)) {
    std::string text;
    for (const std::string& line : input->lines()) text += (text.empty() ? "" : "; ") + line;
    return text;
  }
  return e.what();
}

}  // namespace kerf
