// Groups, datasets and attributes of the file of partitions, by HDF5's library.
#include "partition/partitions_file.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "output/file.hpp"
#include "output/hdf5_handle.hpp"

namespace kerf {

using hdf5::Handle;
using hdf5::put;

PartitionsFile::PartitionsFile(const std::string& path, const std::string& input, std::int64_t n_elements)
    : path_(path), n_elements_(n_elements) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
  file_ = H5Fcreate(unfinished().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  expect(file_ >= 0 && put(file_, "kerf_partitions", std::int64_t{1}) && put(file_, "n_elements", n_elements) &&
         put(file_, "input", input));
}

PartitionsFile::~PartitionsFile() {
  if (file_ < 0) return;
  H5Fclose(file_);
  std::remove(unfinished().c_str());
}

void PartitionsFile::expect(bool good) const {
  if (!good) throw std::runtime_error(path_ + " cannot be written; is the disk full?");
}

void PartitionsFile::name_elements(const std::vector<std::int64_t>& labels) {
  const hsize_t size = labels.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const Handle data(H5Dcreate2(file_, "element_id", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    H5Dclose);
  expect(labels.size() == static_cast<std::size_t>(n_elements_) && data.good() &&
         H5Dwrite(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, labels.data()) >= 0);
}

void PartitionsFile::begin_state(const std::string& state, std::int64_t frame, double time) {
  state_ = state;
  const Handle group(H5Gcreate2(file_, state.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  expect(group.good() && put(group, "frame", frame) && put(group, "time", time));
}

void PartitionsFile::add(const std::string& method, const std::string& type, int n_parts,
                         const std::vector<std::int32_t>& parts, double seconds) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose), storage(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const hsize_t size = parts.size(), chunk = std::min<hsize_t>(size, hsize_t{1} << 18);
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  expect(parts.size() == static_cast<std::size_t>(n_elements_) && H5Pset_create_intermediate_group(links, 1) >= 0 &&
         H5Pset_chunk(storage, 1, &chunk) >= 0 && H5Pset_shuffle(storage) >= 0 && H5Pset_deflate(storage, 1) >= 0);
  const std::string name = state_ + "/" + method + "/" + std::to_string(n_parts);
  const Handle data(H5Dcreate2(file_, name.c_str(), H5T_STD_I32LE, space, links, storage, H5P_DEFAULT), H5Dclose);
  expect(data.good() && H5Dwrite(data, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, parts.data()) >= 0 &&
         put(data, "n_parts", std::int64_t{n_parts}) && put(data, "type", type) && put(data, "seconds", seconds));
}

void PartitionsFile::close() {
  const bool good = H5Fclose(file_) >= 0;
  file_ = -1;
  expect(good);
  publish(unfinished(), path_);
}

}  // namespace kerf
