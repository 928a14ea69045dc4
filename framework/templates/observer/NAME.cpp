// The momentum of a part over time, and the impulse that it has received since time zero.
#include <kerf/observer.hpp>

namespace {

using namespace kerf;

/// P = sum m v over the nodes of the part, those without live elements included.
struct @TYPE@ final : Observer {
  std::string part;
  Vec3 first, last;  // at time zero, and in the last row [kg m/s]
  double rows = 0.0;

  static void describe(Schema<@TYPE@>& s) {
    s.text(&@TYPE@::part, "part", "part that is watched");
    describe_interval(s);
  }

  std::vector<std::string> references() const override { return {part}; }
  std::vector<ObservedColumn> columns() const override {
    return {{"momentum_x", "kg m/s", "momentum of all nodes of the part"},
            {"momentum_y", "kg m/s", "the same along y"},
            {"momentum_z", "kg m/s", "the same along z"}};
  }

  void sample(ObservedModel& model, std::span<double> row) override {
    last = momentum_of(model, model.find_part(part));
    if (rows == 0.0) first = last;
    rows += 1.0;
    for (int d = 0; d < 3; ++d) row[static_cast<std::size_t>(d)] = last[d];
  }
  ObserverReport report(ObservedModel&) override {
    const Vec3 impulse = last - first;
    return {{{"momentum_x", last.x, ""},
             {"momentum_y", last.y, ""},
             {"momentum_z", last.z, ""},
             {"impulse_x", impulse.x, ""},
             {"impulse_y", impulse.y, ""},
             {"impulse_z", impulse.z, ""}},
            {}};
  }

  // What a resumed run needs to go on.
  std::vector<double> state() const override { return {first.x, first.y, first.z, last.x, last.y, last.z, rows}; }
  void restore(std::span<const double> numbers) override {
    first = {numbers[0], numbers[1], numbers[2]};
    last = {numbers[3], numbers[4], numbers[5]};
    rows = numbers[6];
  }

 private:
  /// Collective. `mass_in` is zero for nodes that other ranks own, so each node counts once; `sums` adds the terms of
  /// all ranks to the same bits, however they are distributed.
  static Vec3 momentum_of(ObservedModel& model, int number) {
    const std::vector<double> mass = model.mass_in(number);
    std::vector<double> terms[3];
    for (int i = 0; i < model.nodes.n; ++i) {
      const double m = mass[static_cast<std::size_t>(i)];
      if (!(m > 0.0)) continue;
      const Vec3 v = model.nodes.v(i);
      for (int d = 0; d < 3; ++d) terms[d].push_back(m * v[d]);
    }
    const std::vector<double> s = model.sums({terms[0], terms[1], terms[2]});
    return {s[0], s[1], s[2]};
  }
};

}  // namespace

KERF_OBSERVER(@TYPE@, "@NAME@", "momentum of a part over time, and the impulse that it has received")
