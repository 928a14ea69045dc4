// Look-up of variables in the store of a part.
#include "model/law_reads.hpp"

#include "core/assert.hpp"

namespace kerf {

LawReads::LawReads(const Law& law, const PartStore& store) : inputs_(law.asked_inputs()) {
  for (const ReadVariable& r : law.reads()) {
    const auto [field, component] = store.find_variable(r.name);
    KERF_ASSERT(field != PartStore::n_fields || r.is_optional, "variables that laws read are checked with the input");
    positions_.push_back({field, component, r.value});
  }
  for (const StateVariable& v : law.state_variables())
    if (v.begins_tensor) tensors_.push_back(v.index);
  sources_.resize(positions_.size());
  rows_.resize(positions_.size());
  wide_.resize(positions_.size() * lane_width);
}

LawAccess LawReads::access(PartStore& store) {
  for (std::size_t r = 0; r < positions_.size(); ++r) {
    const Position& p = positions_[r];
    ReadSource& source = sources_[r];
    source = {};
    source.value = p.value;
    if (p.field == PartStore::n_fields) continue;
    Field& f = store.field(p.field);
    source.n_components = f.n_components;
    source.component = p.component;
    if (f.is_single)
      source.single_data = f.entries<float>();
    else
      source.data = f.entries<double>();
  }
  return {sources_, tensors_, inputs_, rows_.data(), wide_.data()};
}

}  // namespace kerf
