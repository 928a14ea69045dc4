// The samples of tests/data/sample_laws.yaml, and blocks of random points for their laws.
#pragma once

#include <memory>
#include <string>

#include "conformance/law_block.hpp"
#include "conformance/samples.hpp"

namespace kerf::test {

using kerf::law_kinds;
using kerf::LawBlock;

/// Owns the law of a sample. Throws std::runtime_error, saying what to do, where there is no sample.
class OwnSampleLaw {
 protected:
  OwnSampleLaw(const std::string& kind, const std::string& name);
  std::unique_ptr<SampleLaws> own_;
};

/// The sample of a registered law, ready to compute.
class SampleLaw : private OwnSampleLaw, public LawPoints {
 public:
  SampleLaw(const std::string& kind, const std::string& name)
      : OwnSampleLaw(kind, name), LawPoints(*own_->law, own_->material.density) {}
};

}  // namespace kerf::test
