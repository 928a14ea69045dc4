// The policy that moves the mesh when that saves more work than it costs.
//
// Sources: D.M. Nicol & J.H. Saltz, "Dynamic remapping of parallel computations with varying resource demands", IEEE
// Trans. Computers 37 (1988) 1073-1087, for weighing a saving against a cost; G. Cybenko, J. Parallel Distrib. Comput.
// 7 (1989) 279-301, for imbalance as what the slowest rank has above the mean.
#include <kerf/balance_policy.hpp>

namespace {

using namespace kerf;

struct Threshold final : BalancePolicy {
  double threshold = 0.0, cost_factor = 0.0;
  std::int64_t interval = 0, cooldown = 0, horizon = 0;  // [cycles]
  std::int64_t window = 0;  // [looks]

  static void describe(Schema<Threshold>& s) {
    s.real(&Threshold::threshold, "threshold", "-", Range{1.0, 100.0, false, false},
           "max/mean of the work model, averaged over the window, above which re-balancing is considered")
        .by_default("1.05");
    s.integer(&Threshold::interval, "check_interval", positive, "cycles between two looks at the imbalance")
        .by_default("50");
    s.integer(
         &Threshold::window, "window", between(1.0, 1000.0),
         "looks that the imbalance is averaged over; a re-balance empties the window, and until it is full nothing "
         "moves")
        .by_default("1");
    s.integer(&Threshold::cooldown, "cooldown", non_negative, "least cycles between two re-balances").by_default("100");
    s.integer(&Threshold::horizon, "horizon", positive, "cycles for which the present imbalance is thought to last")
        .by_default("1000");
    s.real(&Threshold::cost_factor, "cost_factor", "-", non_negative,
           "re-balance only if the predicted saving exceeds this many times the predicted cost")
        .by_default("1.0");
  }

  std::int64_t check_interval() const override { return interval; }

  bool move(const BalanceState& now) override {
    learn_from(now.moves);
    const double mean = look(now.imbalance);
    predict(now, mean);
    reasons_.reason = objection(now, mean);
    if (!reasons_.reason.empty()) return false;
    reasons_.reason = "pays";
    looks_.clear();
    return true;
  }
  BalanceReasons reasons() const override { return reasons_; }

  // A resumed run goes on as if it had not been stopped: the memory of moves, then the window, filled up with zeros.
  std::vector<double> state() const override {
    std::vector<double> numbers{last_after_, last_cost_, static_cast<double>(looks_.size())};
    numbers.insert(numbers.end(), looks_.begin(), looks_.end());
    numbers.resize(n_memory + static_cast<std::size_t>(window), 0.0);
    return numbers;
  }
  void restore(std::span<const double> numbers) override {
    if (numbers.size() < n_memory) return;
    last_after_ = numbers[0];
    last_cost_ = numbers[1];
    const auto n = static_cast<std::size_t>(numbers[2]);
    if (numbers.size() != n_memory + static_cast<std::size_t>(window)) return;  // the window has another length now
    looks_.assign(numbers.begin() + n_memory, numbers.begin() + static_cast<std::ptrdiff_t>(n_memory + n));
  }

 private:
  static constexpr std::size_t n_memory = 3;

  /// What the last re-balance has left behind, and what it has cost by the model.
  void learn_from(std::span<const BalanceMove> moves) {
    if (moves.size() < n_seen_) n_seen_ = 0;
    for (; n_seen_ < moves.size(); ++n_seen_) {
      if (moves[n_seen_].first) continue;
      last_after_ = moves[n_seen_].imbalance_after;
      last_cost_ = moves[n_seen_].modelled_cost;
    }
  }

  /// Mean imbalance over the window.
  double look(double imbalance) {
    looks_.push_back(imbalance);
    if (looks_.size() > static_cast<std::size_t>(window)) looks_.erase(looks_.begin());
    double sum = 0.0;
    for (const double i : looks_) sum += i;
    return sum / static_cast<double>(looks_.size());
  }

  /// The next re-balance is thought to leave and to cost what the last one has. Before the first, it leaves no
  /// imbalance, and what the slowest rank has too much moves.
  void predict(const BalanceState& now, double mean) {
    const double left = now.cycles_left < static_cast<double>(horizon) ? now.cycles_left : static_cast<double>(horizon);
    const double after = last_after_ > 0.0 ? last_after_ : 1.0;
    const double per_rank = static_cast<double>(now.n_elements) / now.n_ranks;
    reasons_.mean_imbalance = mean;
    reasons_.saving = mean > after ? (mean - after) * now.mean_work * left : 0.0;
    reasons_.cost = last_cost_ > 0.0 ? last_cost_ : now.move_cost.of(per_rank, (mean - 1.0) * per_rank);
  }

  std::string objection(const BalanceState& now, double mean) const {
    if (looks_.size() < static_cast<std::size_t>(window)) return "window not full";
    if (!(mean > threshold)) return "below threshold";
    if (now.cycles_since_move < cooldown) return "cooldown";
    if (!(reasons_.saving > cost_factor * reasons_.cost)) return "does not pay";
    return {};
  }

  std::vector<double> looks_;  // the newest last
  double last_after_ = 0.0, last_cost_ = 0.0;  // 0 before the first re-balance
  std::size_t n_seen_ = 0;  // moves of this run that are learnt from
  BalanceReasons reasons_;
};

}  // namespace

KERF_BALANCE_POLICY(Threshold, "threshold", "re-balances when the work saved exceeds the cost of moving")
