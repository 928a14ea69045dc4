// Look-up of names in the input's parts and sets.
#include "model/node_group.hpp"

#include "core/assert.hpp"

namespace kerf {

NodeGroup::NodeGroup(const Model& model, const std::vector<std::string>& names) : all_(names.empty()) {
  for (const std::string& name : names) {
    bool found = false;
    for (std::size_t p = 0; p < model.parts.size(); ++p)
      if (model.parts[p].input->name == name) {
        parts_ |= std::uint64_t{1} << p;
        found = true;
      }
    for (std::size_t s = 0; s < model.set_names.size(); ++s)
      if (model.set_names[s] == name) {
        sets_ |= std::uint64_t{1} << s;
        found = true;
      }
    KERF_ASSERT(found, "names of parts and sets are checked when the input is read");
  }
}

}  // namespace kerf
