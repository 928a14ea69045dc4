// Which exterior facets which loads act on: chosen at time zero, followed through erosion.
//
// The marks are kept with the elements, in PartStore::loaded_faces, and so go wherever these go: to other ranks and
// into restart files.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/load.hpp"
#include "model/model.hpp"

namespace kerf {

class FacetMarks {
 public:
  explicit FacetMarks(const ModelInput& input);
  /// The loads on facets, in the order of the input.
  const std::vector<const FacetLoad*>& laws() const { return laws_; }
  /// Marks the facets of the undeformed model. Local.
  void choose(Model& model) const;

  struct Marked {
    ExteriorFacet facet;
    std::size_t law = 0;  // which of laws()
  };
  /// All marks of live elements of this rank, by element, face and law. Local.
  std::vector<Marked> find(const Model& model) const;

  /// Notes which facets lie behind elements that are about to be eroded; the face of `failing` means nothing. Local.
  void before_erosion(const Model& model, const std::vector<ExteriorFacet>& failing);
  /// Passes the marks of eroded elements on to the facets that their erosion opened, for the loads that follow erosion.
  /// A mark also passes through elements that were eroded in the same step. Returns whether any facet of this rank was
  /// marked. Collective.
  bool after_erosion(Model& model, const std::vector<ExteriorFacet>& opened);

 private:
  using FaceKey = std::array<std::int64_t, 4>;  // ids of nodes, as of face_key()
  /// An element that dies, once for each law that follows erosion and marks it, or once without.
  struct Dying {
    std::array<FaceKey, Shape::most_faces> faces{};
    std::int32_t n_faces = 0, law = none;
  };
  static constexpr std::int32_t none = -1;
  static std::vector<FaceKey> reached(const std::vector<Dying>& dead, std::int32_t law);

  std::vector<const FacetLoad*> laws_;
  bool follows_ = false;  // some law does
  std::vector<Dying> dying_;
};

}  // namespace kerf
