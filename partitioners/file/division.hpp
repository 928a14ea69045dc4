// What a file says about the parts of elements, and the two readers that find it out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kerf {

/// Parts of elements, by ascending ids.
struct Division {
  std::vector<std::int64_t> ids;
  std::vector<std::int32_t> parts;  // from 0 on
  int n_parts = 0;
};

/// What is looked for in a file, and where the answer goes.
struct DivisionRequest {
  std::string path;
  std::string state, method;  // the group of a file of `kerf partition`; the method may be empty
  int n_parts = 0;
  std::int64_t n_elements = 0;  // ids are below
};

/// What a reader found. Without complaints `division` fits the request, or, where `found` is false, the file has none
/// of so many parts, but those of `other_counts`.
struct FoundDivision {
  Division division;
  bool found = false;
  std::vector<int> other_counts;
  bool is_chosen = false;  // by state and method, of a file that has several divisions
  std::int64_t line_beyond = 0;  // of a text: the first line with a part that is not asked for, or 0
  std::vector<std::string> complaints;
};

/// Lines "element part", with blanks or a comma between; what follows a # is a comment.
FoundDivision read_text_division(const DivisionRequest& request);

/// A file of `kerf partition`, or datasets `part` and, if rows are not elements 0, 1, ..., `element`.
FoundDivision read_hdf5_division(const DivisionRequest& request);
bool is_hdf5(const std::string& path);

}  // namespace kerf
