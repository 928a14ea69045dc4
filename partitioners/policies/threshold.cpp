// The policy that moves the mesh when that saves more work than it costs.
#include <kerf/balance_policy.hpp>

namespace {

using namespace kerf;

/// Work of re-balancing, in element cycles per element; see doc/developers/performance.md. A constant of the work
/// model, not a measured time, so that runs repeat.
constexpr double migration_cost = 60.0;

struct Threshold final : BalancePolicy {
  double threshold = 0.0, cost_factor = 0.0;
  std::int64_t interval = 0, cooldown = 0;  // [cycles]

  static void describe(Schema<Threshold>& s) {
    s.real(&Threshold::threshold, "threshold", "-", Range{1.0, 100.0, false, false},
           "max/mean of the work model above which re-balancing is considered")
        .by_default("1.05");
    s.integer(&Threshold::interval, "check_interval", positive, "cycles between two looks at the imbalance")
        .by_default("50");
    s.integer(&Threshold::cooldown, "cooldown", non_negative, "least cycles between two re-balances").by_default("100");
    s.real(&Threshold::cost_factor, "cost_factor", "-", non_negative,
           "re-balance only if the work saved until the end, or in a thousand cycles, exceeds this many times the cost "
           "of moving")
        .by_default("1.0");
  }
  std::int64_t check_interval() const override { return interval; }
  bool move(const BalanceState& s) override {
    if (s.imbalance <= threshold || s.cycles_since_move < cooldown) return false;
    // Both sides per element of the mean rank.
    const double saved = (s.imbalance - 1.0) * (s.cycles_left < 1000.0 ? s.cycles_left : 1000.0);
    return saved > cost_factor * migration_cost;
  }
};

}  // namespace

KERF_BALANCE_POLICY(Threshold, "threshold", "re-balances when the work saved exceeds the cost of moving")
