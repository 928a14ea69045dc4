// The policy that moves the mesh at regular intervals.
#include <kerf/balance_policy.hpp>

namespace {

using namespace kerf;

struct Every final : BalancePolicy {
  std::int64_t interval = 0;  // [cycles]

  static void describe(Schema<Every>& s) {
    s.integer(&Every::interval, "interval", positive, "cycles between two re-balances");
  }
  std::int64_t check_interval() const override { return interval; }
  bool move(const BalanceState&) override { return true; }
};

}  // namespace

KERF_BALANCE_POLICY(Every, "every", "re-balances every so many cycles, whatever the imbalance")
