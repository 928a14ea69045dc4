// A balance policy outside of Kerf's tree: moves once the imbalance has lasted, so that a short burst of erosion does
// not move the mesh twice.
#include <kerf/balance_policy.hpp>

struct Patient final : kerf::BalancePolicy {
  double threshold = 0.0;
  std::int64_t interval = 0, patience = 0;

  static void describe(kerf::Schema<Patient>& s) {
    s.real(&Patient::threshold, "threshold", "-", kerf::Range{1.0, 100.0, false, false},
           "greatest over mean work of the ranks that is borne");
    s.integer(&Patient::interval, "interval", kerf::positive, "cycles between two looks").by_default("20");
    s.integer(&Patient::patience, "patience", kerf::positive, "looks in a row above the threshold before it moves")
        .by_default("3");
  }
  std::int64_t check_interval() const override { return interval; }
  bool move(const kerf::BalanceState& now) override {
    seen_ = now.imbalance > threshold ? seen_ + 1.0 : 0.0;
    if (seen_ < static_cast<double>(patience)) return false;
    seen_ = 0.0;
    return true;
  }
  std::vector<double> state() const override { return {seen_}; }
  void restore(std::span<const double> numbers) override { seen_ = numbers[0]; }

 private:
  double seen_ = 0.0;  // looks in a row above the threshold
};

KERF_BALANCE_POLICY(Patient, "patient", "re-balances once an imbalance has lasted")
