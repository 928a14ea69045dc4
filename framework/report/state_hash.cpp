// Mixing and adding of the bits of all entities.
#include "report/state_hash.hpp"

#include <fmt/format.h>

#include <bit>

namespace kerf {

namespace {

/// The finaliser of splitmix64 (Steele, Lea & Flood 2014), chained.
class Mixer {
 public:
  void add(std::uint64_t v) {
    state_ ^= v;
    state_ += 0x9e3779b97f4a7c15ULL;
    state_ = (state_ ^ state_ >> 30) * 0xbf58476d1ce4e5b9ULL;
    state_ = (state_ ^ state_ >> 27) * 0x94d049bb133111ebULL;
    state_ ^= state_ >> 31;
  }
  void add(double v) { add(std::bit_cast<std::uint64_t>(v + 0.0)); }  // -0 and 0 are one value
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x6b657266;  // "kerf"
};

}  // namespace

std::string state_hash(const Model& model) {
  std::uint64_t sums[2] = {0, 0};
  const NodeStore& nodes = model.nodes;
  for (int i = 0; i < nodes.n(); ++i) {
    if (!nodes.owned[i]) continue;
    Mixer m;
    m.add(static_cast<std::uint64_t>(nodes.id[i]));
    for (int d = 0; d < 3; ++d) m.add(nodes.position[4 * i + d]);
    for (int d = 0; d < 3; ++d) m.add(nodes.velocity[4 * i + d]);
    m.add(nodes.mass[i]);
    sums[0] += m.value();
  }
  for (const PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    std::vector<double> record(static_cast<std::size_t>(store.record_size()));
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      Mixer m;
      m.add(static_cast<std::uint64_t>(store.id(s)));
      store.pack(s, record.data());
      for (const double v : record) m.add(v);
      sums[1] += m.value();
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UINT64_T, MPI_SUM, model.comm);
  Mixer both;
  both.add(sums[0]);
  both.add(sums[1]);
  return fmt::format("{:016x}", both.value());
}

}  // namespace kerf
