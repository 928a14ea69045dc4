// A part of a few elements with laws that are named by strings, moved by a test.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drive/cell_part.hpp"
#include "support/make_law.hpp"

namespace kerf::test {

using kerf::CellMesh;
using kerf::corner;
using kerf::distorted_block;
using kerf::distorted_element;
using kerf::volume_by_divergence;

struct PartLaws {
  std::string element = "{}", strength = "elastic", strength_parameters = "{shear_modulus: 80 GPa}";
  std::string eos = "linear", eos_parameters = "{bulk_modulus: 160 GPa}";
  std::string solid, solid_parameters = "{}";  // in place of strength and eos
  std::vector<std::pair<std::string, std::string>> criteria;  // of erosion, with their parameters
  std::string rule = "any";  // of the criteria
  double density = 8000.0;  // [kg/m3]
  double compression = 1.0;  // mass of the elements over density times volume
};

/// Owns what a CellPart refers to.
class OwnLaws {
 public:
  OwnLaws(const PartLaws& laws, std::unique_ptr<Element> element)
      : own_element_(element ? std::move(element) : make_law<Element>("element", "hex8", laws.element)),
        own_material_(make(laws)) {}

  const MaterialInput& material() const { return own_material_; }
  Element& element() const { return *own_element_; }

 protected:
  std::unique_ptr<Element> own_element_;
  MaterialInput own_material_;

 private:
  static MaterialInput make(const PartLaws& laws) {
    MaterialInput made;
    made.density = laws.density;
    if (!laws.criteria.empty()) {
      made.erosion = std::make_unique<ErosionInput>();
      made.erosion->rule = laws.rule;
      for (const auto& [name, parameters] : laws.criteria)
        made.erosion->criteria.push_back(make_law<ErosionCriterion>("erosion", name, parameters));
    }
    if (!laws.solid.empty()) {
      made.solid = make_law<Solid>("solid", laws.solid, laws.solid_parameters);
      return made;
    }
    made.strength = make_law<Material>("material", laws.strength, laws.strength_parameters);
    made.eos = make_law<Eos>("eos", laws.eos, laws.eos_parameters);
    return made;
  }
};

/// The elements of one part, of hex8 or of another element, which then has its parameters already.
template <class Real>
class PartOf : private OwnLaws, public CellPart<Real> {
 public:
  explicit PartOf(const CellMesh& mesh, const PartLaws& laws = {}, std::unique_ptr<Element> element = nullptr)
      : OwnLaws(laws, std::move(element)), CellPart<Real>(mesh, own_material_, *own_element_, laws.compression) {}
};
using OnePart = PartOf<double>;
using SinglePart = PartOf<float>;

}  // namespace kerf::test
