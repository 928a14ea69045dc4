// One element along a smooth path: halved steps, a rotation on top, another frame, floats.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "conformance/checks.hpp"
#include "conformance/law_path.hpp"

namespace kerf {

namespace {

constexpr int coarsest = 64, n_levels = 4, moments = 32;  // 64, 128, 256, 512 steps
// Below it, a difference is round-off: some hundred steps lose some thousand units of 1e-16, and the largest principal
// value, where two coincide, has eight digits.
constexpr double round_off = 1e-8;
// A kink, such as the onset of flow, falls anywhere within a step, so errors of a law with kinks scatter by a factor of
// two or so about their power of the step. Over three halvings that may take 0.35 off the order.
constexpr double scatter_of_order = 0.35;

struct Order {
  std::size_t quantity = 0;
  double order = 0.0, finest = 0.0;
  bool passes = true;
};

/// Slope of the logarithms of errors, a row per halving, coarsest first.
double slope_of(const std::vector<double>& errors) {
  const double n = static_cast<double>(errors.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double x = static_cast<double>(i), y = kerf::log(errors[i]) / kerf::log(2.0);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return -(n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// The quantity that converges worst. `errors` has a row of quantities per level.
Order worst_order(const std::vector<std::vector<double>>& errors, double order) {
  Order worst;
  worst.order = std::numeric_limits<double>::infinity();
  for (std::size_t q = 0; q < errors.front().size(); ++q) {
    std::vector<double> of_quantity;
    for (const auto& level : errors) of_quantity.push_back(std::max(level[q], 1e-300));
    const double finest = of_quantity.back();
    if (finest < round_off) continue;
    const double slope = slope_of(of_quantity);
    const bool passes = slope >= order - scatter_of_order && std::isfinite(finest);
    if (!(slope < worst.order) && std::isfinite(slope)) continue;
    worst = {q, slope, finest, passes};
    if (!std::isfinite(slope)) break;
  }
  return worst;
}

std::string errors_text(const std::vector<std::vector<double>>& errors, std::size_t q) {
  std::string text;
  for (const auto& level : errors) text += fmt::format("{}{:.2e}", text.empty() ? "" : ", ", level[q]);
  return text;
}

void check_convergence(const SampleLaws& laws, const StretchPath& path, Verdicts& out) {
  const PathRecord exact = drive_path(laws, path, coarsest << (n_levels + 2), moments);
  std::vector<std::vector<double>> errors;
  for (int level = 0; level < n_levels; ++level)
    errors.push_back(differences(exact, drive_path(laws, path, coarsest << level, moments), false));
  const double order = laws.sample.settings.order;
  const Order worst = worst_order(errors, order);
  if (std::isinf(worst.order) && worst.passes)
    out.pass("convergence", "halved steps change nothing beyond round-off");
  else if (worst.passes)
    out.pass("convergence", fmt::format("halved steps converge with order {:.2f} or more, {} last; stated is {:g}",
                                        worst.order, exact.names[worst.quantity], order));
  else
    out.fail(
        "convergence",
        fmt::format("`{}` converges with order {:.2f}, stated is {:g}: its mean errors with {} steps and twice as "
                    "many each time are {} of its greatest size; integrate the rate over the whole of `dt`, or "
                    "state the order as `conformance: {{order: ...}}` in the sample",
                    exact.names[worst.quantity], worst.order, order, coarsest, errors_text(errors, worst.quantity)));
}

void check_objectivity(const SampleLaws& laws, const StretchPath& path, Verdicts& out) {
  StretchPath turning = path;
  turning.angle = 2.0;
  std::vector<std::vector<double>> errors;
  PathRecord still;
  for (int level = 0; level < n_levels; ++level) {
    still = drive_path(laws, path, coarsest << level, moments);
    errors.push_back(differences(still, drive_path(laws, turning, coarsest << level, moments), false));
  }
  const double order = laws.sample.settings.order;
  const Order worst = worst_order(errors, order);
  if (std::isinf(worst.order) && worst.passes)
    out.pass("objectivity", "a rotation by 2 rad during the path changes nothing beyond round-off");
  else if (worst.passes)
    out.pass("objectivity", fmt::format("what a rotation by 2 rad during the path changes falls with order {:.2f} or "
                                        "more of the step, to {:.1e} in {}",
                                        worst.order, worst.finest, still.names[worst.quantity]));
  else
    out.fail(
        "objectivity",
        fmt::format("a rotation by 2 rad during the path changes `{}`, by {} of its greatest size with {} steps and "
                    "twice as many each time, which falls with order {:.2f}; expected {:g}: use no direction that "
                    "is fixed in space, and keep tensors as SymTensor, which the element rotates",
                    still.names[worst.quantity], errors_text(errors, worst.quantity), coarsest, worst.order, order));
}

void check_frame(const SampleLaws& laws, const StretchPath& path, Verdicts& out) {
  if (!laws.sample.settings.isotropic) {
    out.note("rotated_path", "not tested: the sample says that the law is not isotropic");
    return;
  }
  StretchPath turned = path;
  turned.from = 1.1;
  const PathRecord still = drive_path(laws, path, 4 * coarsest, moments);
  const std::vector<double> errors = differences(still, drive_path(laws, turned, 4 * coarsest, moments), true);
  const std::size_t worst = worst_of(errors);
  if (errors[worst] <= round_off)
    out.pass("rotated_path", fmt::format("body and path turned by 1.1 rad give the same to {:.0e}", errors[worst]));
  else
    out.fail(
        "rotated_path",
        fmt::format("body and path turned by 1.1 rad change `{}` by {:.2e} of its greatest size, expected round-off "
                    "({:.0e}): the law prefers a direction in space; write it in invariants and tensors, or say "
                    "`conformance: {{isotropic: false}}` in the sample",
                    still.names[worst], errors[worst], round_off));
}

/// Floats have 24 bits. A step rounds what it keeps by half a unit at most where it turns it, and once more where it
/// adds to it: in the worst case, with all of one sign, that adds up to a unit per step.
void check_floats(const SampleLaws& laws, const StretchPath& path, Verdicts& out) {
  StretchPath turning = path;
  turning.angle = 2.0;
  constexpr int steps = 4 * coarsest;
  constexpr double allowed = steps * 0x1p-24;
  const PathRecord exact = drive_path<double>(laws, turning, steps, moments);
  const PathRecord single = drive_path<float>(laws, turning, steps, moments);
  const std::vector<double> errors = differences(exact, single, true);
  const std::size_t worst = worst_of(errors);
  if (errors[worst] <= allowed)
    out.pass("single_precision", fmt::format("elements with floats differ by {:.1e} in {} steps, in {}; {:.1e} is what "
                                             "rounding explains",
                                             errors[worst], steps, exact.names[worst], allowed));
  else
    out.fail("single_precision",
             fmt::format("`{}` differs by {:.2e} of its greatest size where the element computes with floats, {:.1e} "
                         "is what rounding explains in {} steps; take care of differences of large numbers in what is "
                         "computed in `Real`, or leave out `computes_in_single`",
                         exact.names[worst], errors[worst], allowed, steps));
}

}  // namespace

std::size_t worst_of(const std::vector<double>& values) {
  std::size_t worst = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] <= values[worst])) worst = i;
  return worst;
}

void check_paths(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  const StretchPath path = path_of(sample);
  const SampleLaws laws(registry, sample);
  const auto guarded = [&](const char* check, auto work) {
    if (!out.wants(check)) return;
    try {
      work(laws, path, out);
    } catch (const std::exception& e) {
      out.fail(check, fmt::format("the path cannot be gone to its end: {}", sentence_of(e)));
    }
  };
  guarded("objectivity", check_objectivity);
  guarded("rotated_path", check_frame);
  guarded("convergence", check_convergence);
  guarded("single_precision", check_floats);
}

}  // namespace kerf
