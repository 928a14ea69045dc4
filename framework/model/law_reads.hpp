// Where a law finds the variables that it reads of other laws, and which of its own the element rotates.
#pragma once

#include <utility>
#include <vector>

#include "kerf/element.hpp"
#include "model/part_store.hpp"

namespace kerf {

class LawReads {
 public:
  LawReads() = default;
  /// Pre: the input has been validated, and with it the names of what the law reads.
  LawReads(const Law& law, const PartStore& store);
  /// What the law needs in its rows, valid until the elements of the store come, go or change places, or this moves.
  LawAccess access(PartStore& store);

 private:
  struct Position {
    PartStore::FieldIndex field = PartStore::n_fields;  // n_fields: no law declares the variable
    int component = 0;
    double value = 0.0;
  };
  std::vector<Position> positions_;
  std::vector<int> tensors_;
  unsigned inputs_ = 0;
  // What access() points to.
  std::vector<ReadSource> sources_;
  std::vector<const double*> rows_;
  AlignedVector<double> wide_;
};

}  // namespace kerf
