// What boundary conditions do to the model over time.
#include "kerf/observer.hpp"

namespace kerf {
namespace {

class Reactions final : public Observer {
 public:
  static void describe(Schema<Reactions>& s) { describe_interval(s); }

  ObserverCalls calls() const override { return {.reactions = true}; }

  void prepare(ObservedModel& model) override {
    for (const ObservedReaction& reaction : model.reactions()) conditions.push_back(reaction.name);
    if (conditions.empty())
      throw std::runtime_error("the model has no boundary condition; expected at least one under `boundaries`");
    last.assign(1 + 3 * conditions.size(), 0.0);
  }

  std::vector<ObservedColumn> columns() const override {
    std::vector<ObservedColumn> all;
    for (const std::string& condition : conditions) {
      all.push_back({condition + ".work", "J", "work on the nodes since time zero"});
      for (const char* axis : {"x", "y", "z"}) {
        all.push_back({condition + ".force_" + axis, "N", "mean force on the nodes since the row before"});
        all.push_back({condition + ".impulse_" + axis, "N s", "impulse on the nodes since time zero"});
      }
    }
    return all;
  }

  /// A condition acts in steps, so a force at an instant is noise: the mean since the last row is what a load cell
  /// would show.
  void sample(ObservedModel& model, std::span<double> row) override {
    std::size_t at = 0, k = 1;
    const double passed = model.time - last[0];
    for (const ObservedReaction& reaction : model.reactions()) {
      row[at++] = reaction.work;
      for (int d = 0; d < 3; ++d, ++k) {
        row[at++] = passed > 0.0 ? (reaction.impulse[d] - last[k]) / passed : 0.0;
        row[at++] = reaction.impulse[d];
        last[k] = reaction.impulse[d];
      }
    }
    last[0] = model.time;
  }

  std::vector<double> state() const override { return last; }
  void restore(std::span<const double> numbers) override { last.assign(numbers.begin(), numbers.end()); }

 private:
  std::vector<std::string> conditions;
  std::vector<double> last;  // time of the last row, and the impulses then [s], [N s]
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::Reactions, "reactions", "force, impulse and work of every boundary condition over time")
