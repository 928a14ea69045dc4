// Reads the parts of elements from an HDF5 file: one of `kerf partition`, or one with datasets `part` and `element`.
#include <hdf5.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "division.hpp"

namespace kerf {
namespace {

/// Closes what HDF5 has opened.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "nothing" : text;
}

/// Names of what is in a group, in the order of the alphabet.
std::vector<std::string> names_in(hid_t group) {
  H5G_info_t info;
  std::vector<std::string> names;
  if (H5Gget_info(group, &info) < 0) return names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t size = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (size <= 0) continue;
    std::string name(static_cast<std::size_t>(size) + 1, '\0');
    H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    name.pop_back();
    names.push_back(name);
  }
  return names;
}

bool has(hid_t group, const std::string& name) { return H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0; }

class Hdf5Reader {
 public:
  explicit Hdf5Reader(const DivisionRequest& request) : request_(request) {}

  FoundDivision read() {
    const Handle file(H5Fopen(request_.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file.good())
      complain("the HDF5 file cannot be read; it is damaged, or somebody is writing it");
    else if (has(file, "part"))
      read_plain(file);
    else
      read_partitions(file);
    return std::move(found_);
  }

 private:
  void complain(const std::string& sentence) { found_.complaints.push_back(request_.path + ": error: " + sentence); }

  /// All entries of a list of whole numbers.
  bool read_list(hid_t group, const std::string& name, std::vector<std::int64_t>& values) {
    const Handle data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) {
      complain("`" + name + "` is no dataset; expected a list of whole numbers");
      return false;
    }
    const Handle type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
    if (H5Tget_class(type) != H5T_INTEGER || H5Sget_simple_extent_ndims(space) != 1) {
      complain("`" + name + "` is no list of whole numbers");
      return false;
    }
    values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (H5Dread(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0) return true;
    complain("`" + name + "` cannot be read; the file is damaged");
    return false;
  }

  /// Datasets `part` and `element`.
  void read_plain(hid_t file) {
    std::vector<std::int64_t> parts, elements;
    if (!read_list(file, "part", parts)) return;
    if (has(file, "element")) {
      if (!read_list(file, "element", elements)) return;
    } else {
      elements.resize(parts.size());
      std::iota(elements.begin(), elements.end(), std::int64_t{0});
    }
    if (elements.size() != parts.size())
      return complain("`element` has " + std::to_string(elements.size()) + " entries and `part` has " +
                      std::to_string(parts.size()) + "; expected as many");
    take(elements, parts);
    const int n = found_.division.n_parts;
    found_.found = found_.complaints.empty() && n == request_.n_parts;
    if (found_.complaints.empty() && !found_.found) found_.other_counts.push_back(n);
  }

  /// The tree /STATE/METHOD/NUMBER OF PARTS.
  void read_partitions(hid_t file) {
    found_.is_chosen = true;
    if (!has(file, request_.state))
      return complain("there is no state `" + request_.state + "`; it has " + joined(names_in(file)));
    const Handle state(H5Gopen2(file, request_.state.c_str(), H5P_DEFAULT), H5Gclose);
    if (!state.good()) return complain("`" + request_.state + "` is no group of partitions");
    const std::vector<std::string> methods = names_in(state);
    if (request_.method.empty() && methods.size() != 1)
      return complain("it has partitions of several methods; name one with the key `method`: " + joined(methods));
    const std::string method = request_.method.empty() ? methods.front() : request_.method;
    if (!has(state, method)) return complain("there is no method `" + method + "`; it has " + joined(methods));
    const Handle group(H5Gopen2(state, method.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.good()) return complain("`" + request_.state + "/" + method + "` is no group of partitions");
    const std::string wanted = std::to_string(request_.n_parts);
    if (!has(group, wanted)) return list_counts(group);
    std::vector<std::int64_t> parts, elements;
    if (!read_list(group, wanted, parts)) return;
    if (static_cast<std::int64_t>(parts.size()) != request_.n_elements)
      return complain("it is of a model of " + std::to_string(parts.size()) + " elements, and this one has " +
                      std::to_string(request_.n_elements));
    // What was dead has part -1.
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i] != -1) elements.push_back(static_cast<std::int64_t>(i));
    std::erase(parts, -1);
    take(elements, parts);
    if (found_.division.n_parts > request_.n_parts)
      complain("`" + wanted + "` has part " + std::to_string(found_.division.n_parts - 1) +
               "; expected parts from 0 to " + std::to_string(request_.n_parts - 1));
    found_.division.n_parts = request_.n_parts;  // the last ones may be empty
    found_.found = found_.complaints.empty();
  }

  void list_counts(hid_t group) {
    for (const std::string& name : names_in(group)) {
      int n = 0;
      if (std::from_chars(name.data(), name.data() + name.size(), n).ec == std::errc())
        found_.other_counts.push_back(n);
    }
    std::sort(found_.other_counts.begin(), found_.other_counts.end());
  }

  void take(const std::vector<std::int64_t>& elements, const std::vector<std::int64_t>& parts) {
    std::vector<std::size_t> order(elements.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return elements[a] < elements[b]; });
    Division& d = found_.division;
    for (const std::size_t row : order) {
      const std::int64_t element = elements[row], part = parts[row];
      if (element < 0 || element >= request_.n_elements)
        return complain("row " + std::to_string(row) + ": there is no element " + std::to_string(element) +
                        "; expected a number from 0 to " + std::to_string(request_.n_elements - 1));
      if (part < 0 || part > 0x7ffffffe)
        return complain("row " + std::to_string(row) + ": part " + std::to_string(part) +
                        " is out of range; expected a number from 0 on");
      if (!d.ids.empty() && d.ids.back() == element)
        return complain("row " + std::to_string(row) + ": element " + std::to_string(element) + " has a part already");
      d.ids.push_back(element);
      d.parts.push_back(static_cast<std::int32_t>(part));
      d.n_parts = std::max(d.n_parts, static_cast<int>(part) + 1);
    }
    if (d.ids.empty()) complain("it has the part of no element");
  }

  const DivisionRequest& request_;
  FoundDivision found_;
};

}  // namespace

bool is_hdf5(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
  return H5Fis_hdf5(path.c_str()) > 0;
}

FoundDivision read_hdf5_division(const DivisionRequest& request) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return Hdf5Reader(request).read();
}

}  // namespace kerf
