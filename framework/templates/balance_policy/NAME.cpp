// Re-balances when as much work has been lost since the last time as a re-balance costs.
//
// Source: D.M. Nicol & J.H. Saltz, "Dynamic remapping of parallel computations with varying resource demands", IEEE
// Trans. Computers 37 (1988) 1073-1087. Whoever pays once the loss equals the price pays at most twice what the best
// plan would, whatever comes.
#include <kerf/balance_policy.hpp>

namespace {

using namespace kerf;

/// While the greatest work of a rank is (1 + e) times the mean, a cycle loses e cycles of a balanced mesh.
struct @TYPE@ final : BalancePolicy {
  double cost = 0.0;  // [cycles]
  std::int64_t interval = 0;  // [cycles]
  double lost = 0.0;  // since the last re-balance [cycles]

  static void describe(Schema<@TYPE@>& s) {
    s.real(&@TYPE@::cost, "cost", "-", positive, "cost of a re-balance, in cycles of a balanced mesh")
        .by_default("60");
    s.integer(&@TYPE@::interval, "check_interval", positive, "cycles between two looks at the imbalance")
        .by_default("20");
  }

  std::int64_t check_interval() const override { return interval; }
  bool move(const BalanceState& now) override {
    lost += (now.imbalance - 1.0) * static_cast<double>(interval);
    // At the end of a run what is left to be lost is less than the cost.
    if (lost < cost || (now.imbalance - 1.0) * now.cycles_left < cost) return false;
    lost = 0.0;
    return true;
  }

  // A resumed run goes on as if it had not been stopped.
  std::vector<double> state() const override { return {lost}; }
  void restore(std::span<const double> numbers) override { lost = numbers[0]; }
};

}  // namespace

KERF_BALANCE_POLICY(@TYPE@, "@NAME@", "re-balances when as much work has been lost as a re-balance costs")
