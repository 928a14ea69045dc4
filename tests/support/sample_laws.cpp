// Samples of the laws of Kerf itself.
#include "support/sample_laws.hpp"

#include <stdexcept>

#include "support/make_law.hpp"

namespace kerf::test {

OwnSampleLaw::OwnSampleLaw(const std::string& kind, const std::string& name) {
  static const Samples samples(std::string(KERF_SOURCE_DIR) + "/tests/data/sample_laws.yaml", builtin_plugins());
  const TypeSample* sample = samples.find(kind, name);
  if (!sample)
    throw std::runtime_error("the " + kind + " " + name + " has no sample; give it one in tests/data/sample_laws.yaml");
  own_ = std::make_unique<SampleLaws>(builtin_plugins(), *sample);
}

}  // namespace kerf::test
