// The policy that leaves the mesh where the first distribution has put it.
#include <kerf/balance_policy.hpp>

namespace {

using namespace kerf;

struct Never final : BalancePolicy {
  static void describe(Schema<Never>&) {}
  std::int64_t check_interval() const override { return 0; }
  bool move(const BalanceState&) override { return false; }
};

}  // namespace

KERF_BALANCE_POLICY(Never, "never", "keeps the first distribution")
