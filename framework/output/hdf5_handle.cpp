// Attributes of a single value.
#include "output/hdf5_handle.hpp"

namespace kerf::hdf5 {

namespace {

bool put(hid_t object, const char* name, hid_t type, const void* value) {
  if (H5Aexists(object, name) > 0 && H5Adelete(object, name) < 0) return false;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.good() && H5Awrite(attribute, type, value) >= 0;
}

}  // namespace

bool put(hid_t object, const char* name, std::int64_t value) { return put(object, name, H5T_NATIVE_INT64, &value); }

bool put(hid_t object, const char* name, double value) { return put(object, name, H5T_NATIVE_DOUBLE, &value); }

bool put(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.empty() ? 1 : text.size());
  H5Tset_cset(type, H5T_CSET_UTF8);
  return put(object, name, type, text.empty() ? " " : text.data());
}

}  // namespace kerf::hdf5
